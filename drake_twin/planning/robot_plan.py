"""The plan of a robot whose files have been read: its model, its controllers, its frames."""

import os
from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, field, replace
from pathlib import Path

from drake_twin.controllers.registry import JOINT_STATE_BROADCASTER
from drake_twin.description.controllers_yaml import ControllerManagerParameters, ControllerParameters, read_controllers
from drake_twin.description.gazebo_drive import JointInterface, Servo
from drake_twin.description.gazebo_drives import gazebo_drives
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import Joint, Pose, RobotDescription
from drake_twin.description.robot_model import RobotModel
from drake_twin.description.robot_models import RobotModels
from drake_twin.description.xacro_file import xacro_arguments
from drake_twin.description.yaml_document import ValuePath
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind, texts
from drake_twin.planning.controller_plan import ControllerPlan
from drake_twin.planning.gazebo_drive_plan import usable_drives, with_actuators
from drake_twin.planning.idle_hardware import idle_joints, joints_in_state
from drake_twin.planning.plan_controllers import plan_controllers
from drake_twin.planning.plugin_remappings import with_plugin_remappings
from drake_twin.planning.sensor_plan import SensorPlan, plan_sensors
from drake_twin.planning.servo_plan import hold_joints, plugin_servos, position_time_constant
from drake_twin.scenario import Robot, ScenarioError

_SAME = 1e-6  # rad or m; positions that differ by less are the same


@dataclass(frozen=True)
class RobotPlan:
    """A robot, ready to be built.

    Attributes:
        robot: The scenario's entry.
        model: Its description and its text for Drake.
        controllers: The controllers of its parameters files and plugins, in order.
        update_rate: Its controller manager's rate (Hz).
        enforce_limits: Whether commands are clamped to the joints' limits.
        hold_joints: Whether an unclaimed joint is held.
        position_time_constant: Error / velocity of its position servos (s).
        servos: (joint, command interface) → how a Gazebo plugin follows its commands.
        frame_prefix: The prefix of its link names in tf messages.
        start_positions: Movable joint → start position (rad or m).
        findings: The findings of its files: entries that were not used as they are.
        hardware_states: ``<ros2_control>`` tag → ``inactive`` or ``unconfigured`` where it is not active.
        strictness: The strictness of a switch that names none, as in ``controller_manager_msgs/srv/SwitchController``.
        uses_inactive_hardware: Whether controllers may claim interfaces of inactive hardware.
        sensors: The sensors that are simulated.
    """

    robot: Robot
    model: RobotModel
    controllers: tuple[ControllerPlan, ...]
    update_rate: float
    enforce_limits: bool
    hold_joints: bool
    position_time_constant: float
    frame_prefix: str
    start_positions: Mapping[str, float]
    findings: tuple[Finding, ...] = ()
    servos: Mapping[JointInterface, Servo] = field(default_factory=dict)
    hardware_states: Mapping[str, str] = field(default_factory=dict)
    strictness: int = 1
    uses_inactive_hardware: bool = False
    sensors: tuple[SensorPlan, ...] = ()

    @property
    def idle_joints(self) -> dict[str, str]:
        """Joint → why its hardware cannot be commanded."""
        return idle_joints(self.description, self.hardware_states, uses_inactive=self.uses_inactive_hardware)

    @property
    def unconfigured_joints(self) -> frozenset[str]:
        """The joints and GPIOs whose interfaces are not available."""
        return frozenset(joints_in_state(self.description, self.hardware_states, "unconfigured"))

    @property
    def not_started(self) -> tuple[str, ...]:
        """The controllers and drives that are not active, each with the reason."""
        return texts(self.findings, Kind.NOT_STARTED)

    @property
    def warnings(self) -> tuple[str, ...]:
        """The findings of entries that were repaired or have no effect."""
        return texts(self.findings, Kind.WARNING, Kind.MENDED)

    @property
    def errors(self) -> tuple[InputError, ...]:
        """The errors of controllers that should be loaded, first the missing ones."""
        errors = [item.error for item in self.controllers if item.error is not None]
        return tuple(sorted(errors, key=lambda error: not isinstance(error, ScenarioError)))

    @property
    def name(self) -> str:
        """The robot's name in the twin."""
        return self.robot.name

    @property
    def description(self) -> RobotDescription:
        """The robot as its file describes it."""
        return self.model.description

    @property
    def spawn_pose(self) -> Pose:
        """The start pose of the root link in the world: the robot's pose is that of its model's frame, as in Gazebo."""
        return Pose(self.robot.xyz, self.robot.rpy).compose(self.description.root_pose)

    @property
    def friction_joints(self) -> tuple[Joint, ...]:
        """The joints whose dry friction is modeled; a follower's is part of its leader's."""
        if "joint_friction" in self.robot.without_repairs:
            return ()
        return tuple(joint for joint in self.description.movable_joints if joint.friction > 0 and joint.mimic is None)

    @property
    def follows_mujoco(self) -> bool:
        """Whether its actuators are those of an MJCF file: each has its gains, and its ``ctrlrange`` always holds."""
        return self.model.drake_format == "xml"

    @property
    def base_frame(self) -> str:
        """The frame of the root link."""
        return self.frame_prefix + self.description.root_link


def plan_robot(
    robot: Robot, packages: PackageIndex, path: ValuePath = (), models: RobotModels | None = None
) -> RobotPlan:
    """Read a robot's files and plan what the twin starts of them.

    Args:
        robot: The scenario's entry.
        packages: Resolves the addresses of files.
        path: The path of the entry in the scenario, for error messages.
        models: The models of the robots that are planned with it.

    Raises:
        InputError: If a file or a joint is missing or wrong.
    """
    xacro_args = dict(robot.xacro_args)
    try:
        file = packages.resolve(robot.model)
    except InputError as error:
        raise ScenarioError((*path, "model"), str(error)) from None
    declared = xacro_arguments(file, packages)
    if "robot_name" in declared:
        xacro_args.setdefault("robot_name", robot.name)
    warnings = [
        f"{file.name} has no xacro argument {name!r} (it has {', '.join(sorted(declared)) or 'none'})"
        for name in xacro_args
        if name not in declared
    ]
    model = (models or RobotModels(packages)).load(
        robot.model,
        name=robot.name,
        xacro_args=xacro_args,
        without_repairs=robot.without_repairs,
        collision=robot.collision,
    )
    own = model.description
    drives, drive_findings = usable_drives(gazebo_drives(own), model.is_fixed)
    description = _with_joint_friction(robot, path, with_actuators(own, drives))
    model = replace(model, description=description)
    warnings += _unused_interfaces(description)
    manager = _with_added(robot, path, _controller_manager(robot, path, own, packages, xacro_args))
    manager = _with_parameters(robot, path, manager)
    robot = with_plugin_remappings(robot, own, [item.name for item in manager.controllers])
    controllers, controller_findings = plan_controllers(
        robot, path, description, manager, xacro_args.get("prefix", ""), drives
    )
    hardware = {system.name for system in own.systems}
    controller_findings += [
        Finding.at(Kind.WARNING, f"hardware component {name!r} is unknown, so it is not set to {state}", place)
        for name, (state, place) in manager.hardware_states.items()
        if name not in hardware
    ]
    starts = {joint: position for drive in drives for joint, position in drive.start.items()}
    positions, position_warnings = _start_positions(robot, path, description, starts)
    warnings += position_warnings
    frame_prefix = _frame_prefix(robot, description)
    sensors, sensor_findings = plan_sensors(robot, description, frame_prefix)
    files = robot.controllers or own.controller_files
    if files and not manager.controllers:
        warnings.append(
            f"{', '.join(map(str, files))}: no controllers found for the namespace {robot.topic_namespace or '/'!r};"
            " they must be below 'controller_manager:' and 'ros__parameters:', each with its 'type:'"
        )
    return RobotPlan(
        robot=robot,
        model=model,
        controllers=controllers,
        update_rate=manager.update_rate,
        enforce_limits=manager.enforce_command_limits,
        hold_joints=hold_joints(description),
        position_time_constant=position_time_constant(description, manager.update_rate),
        servos=plugin_servos(own, drives),
        frame_prefix=frame_prefix,
        start_positions=positions,
        findings=tuple(
            replace(finding, robot=robot.name, file=finding.file or str(file))
            for finding in (
                *model.findings,
                *drive_findings,
                *manager.findings,
                *controller_findings,
                *(Finding(Kind.WARNING, warning) for warning in warnings),
                *sensor_findings,
            )
        ),
        hardware_states={name: state for name, (state, _) in manager.hardware_states.items() if name in hardware},
        strictness=manager.strictness,
        uses_inactive_hardware=manager.uses_inactive_hardware,
        sensors=sensors,
    )


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


def _controller_manager(
    robot: Robot, path: ValuePath, description: RobotDescription, packages: PackageIndex, xacro_args: Mapping[str, str]
) -> ControllerManagerParameters:
    files = robot.controllers or description.controller_files
    placeholders = {"robot_name": robot.name, **xacro_args}
    if not files:
        return ControllerManagerParameters() if robot.added_controllers else _default_controllers(description)
    resolved = []
    for file in files:
        try:
            resolved.append(packages.resolve_as_started(file, description.file))
        except InputError as error:
            name = Path(file).name  # a launch file gives the plugin's own as an absolute path
            named = [
                item.place for item in description.plugins if name in {Path(each).name for each in item.parameters}
            ]
            if named:
                what = f"the ros2_control plugin's parameters file: {error}"
                raise InputError(what, file=named[0].file, line=named[0].line) from None
            raise ScenarioError((*path, "controllers"), str(error)) from None
    parameters = read_controllers(resolved, robot.topic_namespace, placeholders)
    for plugin in description.plugins:
        if not parameters.controllers and plugin.namespace:  # for the namespace in the robot's file
            parameters = read_controllers(resolved, f"/{plugin.namespace.strip('/')}", placeholders)
    elsewhere = [
        Finding(Kind.WARNING, f"the controllers' file {given} is not on this machine: {file} is used")
        for given, file in zip(files, resolved, strict=True)
        if Path(given).is_absolute() and Path(os.path.abspath(given)) != file
    ]
    return replace(parameters, findings=(*parameters.findings, *elsewhere)) if elsewhere else parameters


def _with_added(robot: Robot, path: ValuePath, manager: ControllerManagerParameters) -> ControllerManagerParameters:
    """Return the parameters files' controllers and those that the scenario adds."""
    added = []
    for name, entry in robot.added_controllers.items():
        parameters = dict(entry)
        kind = parameters.pop("type", None)
        if not isinstance(kind, str):
            raise ScenarioError((*path, "added_controllers", name), "the controller has no type")
        if any(controller.name == name for controller in manager.controllers):
            raise ScenarioError(
                (*path, "added_controllers", name), "the parameters files have a controller of this name"
            )
        added.append(ControllerParameters(name, kind, parameters))
    return replace(manager, controllers=(*added, *manager.controllers)) if added else manager


def _with_parameters(
    robot: Robot, path: ValuePath, manager: ControllerManagerParameters
) -> ControllerManagerParameters:
    """Return the controllers with the parameters that the scenario replaces."""
    if not robot.controller_parameters:
        return manager
    known = {controller.name: controller for controller in manager.controllers}
    for name, given in robot.controller_parameters.items():
        if name not in known:
            at = (*path, "controller_parameters", name)
            raise ScenarioError(at, f"the robot has no controller {name!r}", value=name, valid=known)
        parameters = deepcopy(dict(known[name].parameters))
        for parameter, value in given.items():
            *folders, last = parameter.split(".")
            place = parameters
            for folder in folders:
                below = place.get(folder)
                place[folder] = below = below if isinstance(below, dict) else {}
                place = below
            place[last] = value
        known[name] = replace(known[name], parameters=parameters)
    return replace(manager, controllers=tuple(known.values()))


def _with_joint_friction(robot: Robot, path: ValuePath, description: RobotDescription) -> RobotDescription:
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


def _default_controllers(description: RobotDescription) -> ControllerManagerParameters:
    """Return the controllers of a robot without parameters files: every joint can be commanded in one way."""
    joints: dict[str, list[str]] = {}
    for joint in description.actuated_joints:
        interfaces = [item.name for item in description.controlled_joints[joint.name].command_interfaces]
        preferred = next((name for name in ("velocity", "position", "effort") if name in interfaces), "")
        if preferred:
            joints.setdefault(preferred, []).append(joint.name)
    if not joints:
        return ControllerManagerParameters()
    kind = "forward_command_controller/ForwardCommandController"
    return ControllerManagerParameters(
        controllers=(
            ControllerParameters("joint_state_broadcaster", JOINT_STATE_BROADCASTER, {}),
            *(
                ControllerParameters(f"forward_{name}_controller", kind, {"joints": names, "interface_name": name})
                for name, names in joints.items()
            ),
        )
    )


def _frame_prefix(robot: Robot, description: RobotDescription) -> str:
    if robot.frame_prefix is not None:
        return robot.frame_prefix
    own = (f"{robot.name}_", f"{robot.name}/")
    named_after_robot = all(link == "world" or link.startswith(own) for link in description.links)
    return "" if named_after_robot else f"{robot.name}/"


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
