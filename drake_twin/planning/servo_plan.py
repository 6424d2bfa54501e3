"""How a robot's files say that its joints follow commands: the settings of gz_ros2_control and other hardware."""

from collections.abc import Iterator, Sequence
from math import nan
from pathlib import Path

from drake_twin.description.gazebo_drive import GazeboDrive, JointInterface, Servo
from drake_twin.description.robot_description import MUJOCO, RobotDescription
from drake_twin.errors import InputError
from drake_twin.findings import Place


def _settings(description: RobotDescription, name: str) -> Iterator[tuple[str, Place]]:
    """Yield a setting of gz_ros2_control from the places where a robot file may have it: hardware and plugin."""
    for system in description.systems:
        if name in system.parameters:
            yield system.parameters[name], system.place
    for plugin in description.plugins:
        yield from ((text, plugin.place) for text in plugin.elements.get(name, ()))


def hold_joints(description: RobotDescription) -> bool:
    """Return whether a joint that no controller claims is held."""
    settings = _settings(description, "hold_joints")
    return next((text.strip().lower() not in ("false", "0") for text, _ in settings), True)


# Hardware that follows a commanded position within an update: classic Gazebo's sets it, mock hardware copies it.
_AT_ONCE = ("gazebo_ros2_control/", "mock_components/", "fake_components/")
_SLOWEST, _FASTEST = 1e-6, 1e6  # velocity over error that a servo may have (1/s)
_PROPORTIONAL_GAIN = 0.1  # gz_ros2_control's default


def position_time_constant(description: RobotDescription, update_rate: float) -> float:
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


def plugin_servos(description: RobotDescription, drives: Sequence[GazeboDrive]) -> dict[JointInterface, Servo]:
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
