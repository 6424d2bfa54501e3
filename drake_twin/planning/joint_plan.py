"""The plan of a robot's joints: where they start, and how they follow commands."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import nan
from pathlib import Path

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import GazeboDrive, JointInterface, Servo
from drake_twin.description.robot_description import MUJOCO, RobotDescription
from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.scenario import Robot, ScenarioError
from drake_twin.typed_data import ValuePath

# Hardware that follows a commanded position within an update: classic Gazebo's sets it, mock hardware copies it.
_AT_ONCE = ("gazebo_ros2_control/", "mock_components/", "fake_components/")
_SLOWEST, _FASTEST = 1e-6, 1e6  # velocity over error that a servo may have (1/s)
_PROPORTIONAL_GAIN = 0.1  # gz_ros2_control's default
_SAME = 1e-6  # rad or m; positions that differ by less are the same


@dataclass(frozen=True)
class JointPlan:
    """Where a robot's joints start, and how they follow commands.

    Attributes:
        start_positions: Movable joint → start position (rad or m).
        are_held: Whether an unclaimed joint is held.
        position_time_constant: Error / velocity of the position servos (s).
        servos: (joint, command interface) → how a Gazebo plugin follows its commands.
    """

    start_positions: Mapping[str, float]
    are_held: bool
    position_time_constant: float
    servos: Mapping[JointInterface, Servo]


def plan_joints(
    robot: Robot,
    path: ValuePath,
    own: RobotDescription,
    description: RobotDescription,
    drives: Sequence[GazeboDrive],
    update_rate: float,
) -> tuple[JointPlan, list[str]]:
    """Plan a robot's joints.

    Args:
        robot: The scenario's entry.
        path: The path of the entry in the scenario, for error messages.
        own: The robot as its file describes it.
        description: The robot with what Gazebo plugins command.
        drives: These plugins.
        update_rate: The controller manager's rate (Hz).

    Returns:
        The plan, and warnings of values that are not used as they are.
    """
    starts = {joint: position for drive in drives for joint, position in drive.start.items()}
    positions, warnings = _start_positions(robot, path, description, starts)
    time_constant = _position_time_constant(description, update_rate)
    plan = JointPlan(positions, _are_held(description), time_constant, _plugin_servos(own, drives))
    return plan, _unused_interfaces(description) + warnings


def with_joint_friction(robot: Robot, path: ValuePath, description: RobotDescription) -> RobotDescription:
    """Return the description with the dry friction that the scenario gives its joints."""
    if not robot.joint_friction:
        return description
    movable = [joint.name for joint in description.movable_joints]
    for name in robot.joint_friction:
        if name not in movable:
            at = (*path, "joint_friction")
            raise ScenarioError(at, f"the robot has no movable joint {name!r}", value=name, valid=movable)
    given = robot.joint_friction
    joints = (replace(joint, friction=given.get(joint.name, joint.friction)) for joint in description.joints)
    return replace(description, joints=tuple(joints))


def _unused_interfaces(description: RobotDescription) -> list[str]:
    """Return warnings of ``<ros2_control>`` joints that the twin cannot drive: unknown or without a position."""
    warnings = []
    unknown = []
    for system in description.systems:
        for joint in system.joints:
            known = description.joints_by_name.get(joint.name)
            if known is None:
                unknown.append(joint.name)
            elif joint.command_interfaces and not known.is_movable:
                warnings.append(f"joint {joint.name!r} has command interfaces, but it is {known.type}")
    if unknown:
        warnings.insert(0, f"<ros2_control> names joints that the robot does not have: {', '.join(unknown)}")
    return warnings


def _start_positions(
    robot: Robot, path: ValuePath, description: RobotDescription, starts: Mapping[str, float]
) -> tuple[dict[str, float], list[str]]:
    """Return positions from the scenario, else the robot's file, else zero; within limits, followers at their places.

    Args:
        robot: The scenario's entry.
        path: The path of the entry in the scenario.
        description: The robot, with its ``initial_value``s.
        starts: The start positions of Gazebo's plugins.
    """
    joints = {joint.name: joint for joint in description.movable_joints}
    warnings = []
    for name in robot.initial_positions:
        if name not in joints:
            raise ScenarioError(
                (*path, "initial_positions"), f"the robot has no movable joint {name!r}", value=name, valid=joints
            )
    positions: dict[str, float] = {}
    for tag in description.controlled_joints.values():
        warnings += [
            f"joint {tag.name}: the initial_value {item.initial_value:g} of its {item.name} is ignored: joints"
            " start at rest"
            for item in tag.state_interfaces
            if item.name != "position" and item.initial_value
        ]
    at_limits: dict[str, list[str]] = {}
    for name, joint in joints.items():
        value = robot.initial_positions.get(name, starts.get(name))
        if value is None:
            controlled = description.controlled_joints.get(name)
            interfaces = controlled.state_interfaces if controlled else ()
            initial = [item.initial_value for item in interfaces if item.name == "position"]
            value = next((item for item in initial if item is not None), 0.0)
        clamped = min(max(value, joint.limits.lower), joint.limits.upper)
        if clamped != value:
            at_limits.setdefault(f"{clamped:g} instead of {value:g}", []).append(name)
        positions[name] = clamped
    for start, names in at_limits.items():
        who = f"joint {names[0]} starts at its" if len(names) == 1 else f"joints {', '.join(names)} start at their"
        warnings.append(f"{who} limit {start}")
    found = description.with_followers(positions)
    for name, value in robot.initial_positions.items():
        mimic = joints[name].mimic
        if mimic is not None and abs(found[name] - value) > _SAME:
            warnings.append(f"joint {name} follows {mimic.joint}: it starts at {found[name]:g} instead of {value:g}")
    return found, warnings


def _settings(description: RobotDescription, name: str) -> Iterator[tuple[str, Place]]:
    """Yield a setting of gz_ros2_control from the places where a robot file may have it: hardware and plugin."""
    for system in description.systems:
        if name in system.parameters:
            yield system.parameters[name], system.place
    for plugin in description.plugins:
        yield from ((text, plugin.place) for text in plugin.elements.get(name, ()))


def _are_held(description: RobotDescription) -> bool:
    """Return whether a joint that no controller claims is held."""
    settings = _settings(description, "hold_joints")
    return next((text.strip().lower() not in ("false", "0") for text, _ in settings), True)


def _position_time_constant(description: RobotDescription, update_rate: float) -> float:
    """Return error over velocity of the robot's position servos (s).

    gz_ros2_control's velocity is gain · error · update rate; the hardware of real robots is taken for it.

    Raises:
        InputError: If the file's gain is not a positive number.
    """
    for text, place in _settings(description, "position_proportional_gain"):
        at = Path(place.file) if place.file else description.file
        try:
            gain = float(text)
        except ValueError:
            gain = nan
        if not gain > 0:
            what = f"{text!r}, which is not a positive number"
            raise InputError(f"position_proportional_gain is {what}", file=at, line=place.line)
        if not _SLOWEST <= gain * update_rate <= _FASTEST:
            what = f"{text!r}, and {update_rate:g} Hz times that is not from {_SLOWEST:g} to {_FASTEST:g} 1/s"
            raise InputError(f"position_proportional_gain is {what}", file=at, line=place.line)
        return 1.0 / (gain * update_rate)
    systems = [system for system in description.systems if system.plugin]
    at_once = bool(systems) and all(system.plugin.startswith(_AT_ONCE) for system in systems)
    return 1.0 / ((1.0 if at_once else _PROPORTIONAL_GAIN) * update_rate)


def _plugin_servos(description: RobotDescription, drives: Sequence[GazeboDrive]) -> dict[JointInterface, Servo]:
    """Return how plugins follow commands, where no ``<ros2_control>`` commands the joint: the first of two has it.

    An MJCF robot's actuators follow them as MuJoCo's do: a motor has no gains.
    """
    servos: dict[JointInterface, Servo] = {
        (joint.name, command.name): Servo(
            float(joint.parameters["kv" if command.name == "velocity" else "kp"]), float(joint.parameters["kv"])
        )
        for system in description.systems
        if system.plugin == MUJOCO
        for joint in system.joints
        for command in joint.command_interfaces
    }
    for drive in drives:
        for (joint, interface), servo in drive.servos.items():
            known = description.controlled_joints.get(joint)
            if known is None or interface not in {item.name for item in known.command_interfaces}:
                servos.setdefault((joint, interface), servo)
    return servos
