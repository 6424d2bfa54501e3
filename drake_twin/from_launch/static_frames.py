"""The command line of tf2_ros/static_transform_publisher, in its old and its new form."""

from math import atan2, hypot, isfinite

from drake_twin.description.robot_description import Vector3
from drake_twin.from_launch.command_line import CommandLine, command_line
from drake_twin.ros2.launched import LaunchedProcess
from drake_twin.scenario import StaticTransform

_NUMBERS = ("x", "y", "z", "roll", "pitch", "yaw", "qx", "qy", "qz", "qw")


def static_frame(process: LaunchedProcess) -> StaticTransform:
    """Return the transform that a static_transform_publisher publishes.

    Args:
        process: The node. Old form: ``x y z yaw pitch roll parent child``, or with a quaternion ``x y z qx qy qz qw
            parent child``. New form: ``--x 1 --yaw 0.5 --frame-id parent --child-frame-id child``.

    Raises:
        InputError: If the command line has neither form, or both.
    """
    line = command_line(process)
    options = {name for name in line.options if name not in ("ros-args",)}
    if line.words and options:
        raise line.error("the old form of arguments (numbers and frames) and the new one (--x …) exclude each other")
    return _new_form(line) if options else _old_form(line)


def _new_form(line: CommandLine) -> StaticTransform:
    for name in line.options:
        if name not in (*_NUMBERS, "frame-id", "child-frame-id"):
            raise line.error(f"unknown option --{name}")
    parent, child = line.text("frame-id"), line.text("child-frame-id")
    if parent is None or child is None:
        raise line.error(f"--{'frame-id' if parent is None else 'child-frame-id'} is missing")
    turned = any(name in line.options for name in ("roll", "pitch", "yaw"))
    by_quaternion = any(name in line.options for name in ("qx", "qy", "qz", "qw"))
    if turned and by_quaternion:
        raise line.error("roll, pitch, yaw and a quaternion exclude each other")
    rpy = (line.number("roll"), line.number("pitch"), line.number("yaw"))
    if by_quaternion:
        w = line.number("qw") if "qw" in line.options else 1.0
        rpy = roll_pitch_yaw(line, line.number("qx"), line.number("qy"), line.number("qz"), w)
    xyz = (line.number("x"), line.number("y"), line.number("z"))
    return _checked(line, parent, child, xyz, rpy)


def _old_form(line: CommandLine) -> StaticTransform:
    words = line.words
    if len(words) not in (8, 9):
        raise line.error(
            f"it has {len(words)} arguments; 8 (x y z yaw pitch roll parent child) or 9 (with a quaternion) are needed"
        )
    try:
        numbers = [float(word) for word in words[:-2]]
    except ValueError:
        raise line.error(f"{' '.join(words[:-2])!r} must all be numbers") from None
    x, y, z = numbers[:3]
    if len(words) == 8:
        yaw, pitch, roll = numbers[3:]
        rpy = (roll, pitch, yaw)
    else:
        rpy = roll_pitch_yaw(line, *numbers[3:])
    return _checked(line, words[-2], words[-1], (x, y, z), rpy)


def _checked(line: CommandLine, parent: str, child: str, xyz: Vector3, rpy: Vector3) -> StaticTransform:
    if not all(isfinite(number) for number in (*xyz, *rpy)):
        raise line.error("a number is not finite")
    return StaticTransform(parent.strip("/"), child.strip("/"), xyz, rpy)


def roll_pitch_yaw(line: CommandLine, x: float, y: float, z: float, w: float) -> Vector3:
    """Return a quaternion as roll, pitch, yaw (rad).

    Raises:
        InputError: If it is zero, at the line's place.
    """
    norm = (x * x + y * y + z * z + w * w) ** 0.5
    if not norm > 0:
        raise line.error("the quaternion is zero")
    x, y, z, w = x / norm, y / norm, z / norm, w / norm
    # The elements of the first and the third column of the rotation matrix from which roll, pitch and yaw follow.
    forward, left = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w)
    level = hypot(forward, left)
    pitch = atan2(2.0 * (w * y - x * z), level)
    if level < 1e-7:  # with the x axis vertical, roll and yaw rotate about the same axis: all of it is yaw
        return 0.0, pitch, atan2(2.0 * (w * z - x * y), 1.0 - 2.0 * (x * x + z * z))
    return atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)), pitch, atan2(left, forward)
