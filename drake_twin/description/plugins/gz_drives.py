"""The drives among the systems of gz-sim, as controllers."""

from collections.abc import Iterable
from math import atan, inf, sin
from typing import Any

from drake_twin.description.controllers_yaml import DEFAULT_UPDATE_RATE
from drake_twin.description.gazebo_drive import (
    FOR_EVER,
    PLANAR_INTERFACES,
    PLANAR_MOVE,
    CannotWorkError,
    DrivePlugin,
    GazeboDrive,
    as_rate,
    gazebo_plugin,
)
from drake_twin.description.robot_description import RobotDescription

# gz's topics: the element that names them, and the name below the model without it.
_ODOMETRY = ("odom_topic", "odometry")
_TF = {"tf_odometry": ("tf_topic", "tf")}


@gazebo_plugin("gz-sim-diff-drive-system")
def diff_drive_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-diff-drive-system`` to a diff_drive_controller."""
    left, right = plugin.joints("left_joint"), plugin.joints("right_joint")
    if len(left) != len(right):
        raise CannotWorkError(f"there are {len(left)} left and {len(right)} right joints")
    rate = _odometry_rate(plugin)
    parameters = _gz_odometry(plugin, rate) | {
        "left_wheel_names": list(left),
        "right_wheel_names": list(right),
        "wheel_separation": plugin.number("wheel_separation", 1.0),
        "wheel_radius": plugin.number("wheel_radius", 0.2),
        "cmd_vel_timeout": 0.0,
        "publish_rate": rate,
        "tf_frame_prefix_enable": not plugin.has("frame_id"),
        "linear": {"x": gz_limits(plugin, "linear")},
        "angular": {"z": gz_limits(plugin, "angular")},
    }
    return plugin.drive(
        "diff_drive_controller/DiffDriveController",
        parameters,
        {"cmd_vel_unstamped": ("topic", "cmd_vel"), "odom": _ODOMETRY} | _TF,
        interfaces=tuple((joint, "velocity") for joint in (*left, *right)),
        odometry_rate=rate,
    )


@gazebo_plugin("gz-sim-mecanum-drive-system")
def mecanum_drive_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-mecanum-drive-system`` to a mecanum_drive_controller."""
    wheels = {}
    for there, here in (
        ("front_left", "front_left"),
        ("front_right", "front_right"),
        ("back_right", "rear_right"),
        ("back_left", "rear_left"),
    ):
        wheels[f"{here}_wheel_command_joint_name"], *more = plugin.joints(f"{there}_joint")
        if more:
            raise CannotWorkError(f"there are {1 + len(more)} <{there}_joint>, but only four wheels are supported")
    limits, rate = gz_limits(plugin), _odometry_rate(plugin)
    parameters = (
        _gz_odometry(plugin, rate)
        | wheels
        | {
            "reference_timeout": FOR_EVER,
            "kinematics": {
                "wheels_radius": plugin.number("wheel_radius", 0.2),
                "sum_of_robot_center_projection_on_X_Y_axis": 0.5
                * (plugin.number("wheel_separation", 1.0) + plugin.number("wheelbase", 1.0)),
            },
            "tf_frame_prefix_enable": not plugin.has("frame_id"),
            "linear": {"x": limits, "y": limits},
            "angular": {"z": limits},
        }
    )
    return plugin.drive(
        "mecanum_drive_controller/MecanumDriveController",
        parameters,
        {"reference_unstamped": ("topic", "cmd_vel"), "odometry": _ODOMETRY} | _TF,
        interfaces=tuple((joint, "velocity") for joint in wheels.values()),
        odometry_rate=rate,
    )


@gazebo_plugin("gz-sim-ackermann-steering-system")
def ackermann_steering_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-ackermann-steering-system`` to an ackermann_steering_controller."""
    if plugin.flag("steering_only", False) or plugin.flag("use_actuator_msg", False):
        raise CannotWorkError("<steering_only> and <use_actuator_msg> are not supported")
    steering = (*plugin.joints("right_steering_joint")[:1], *plugin.joints("left_steering_joint")[:1])
    driven, warnings = [], []
    for tag in ("right_joint", "left_joint"):
        joints = plugin.joints(tag)
        fixed = [joint for joint in joints if not _is_below(plugin.description, joint, steering)]
        driven.append((fixed or joints)[0])
        if len(joints) > 1:
            warnings.append(f"of <{tag}> {', '.join(joints)} the twin drives {driven[-1]}; the others roll")
    rate = _odometry_rate(plugin)
    parameters = _gz_odometry(plugin, rate) | {
        "traction_joints_names": driven,
        "steering_joints_names": list(steering),
        "reference_timeout": FOR_EVER,
        "wheelbase": plugin.number("wheel_base", 1.0),
        "traction_wheels_radius": plugin.number("wheel_radius", 0.2),
        "traction_track_width": plugin.number("wheel_separation", 1.0),
        "steering_track_width": plugin.number("kingpin_width", 0.8),
        # gz takes wheel_base / sin(limit) for the smallest turning radius
        "largest_steering_angle": atan(sin(plugin.number("steering_limit", 0.5))),
        "linear": {"x": gz_limits(plugin)},
        "angular": {"z": gz_limits(plugin)},
    }
    return plugin.drive(
        "ackermann_steering_controller/AckermannSteeringController",
        parameters,
        {"reference_unstamped": ("topic", plugin.text("sub_topic", "cmd_vel")), "odometry": _ODOMETRY} | _TF,
        interfaces=(*((joint, "velocity") for joint in driven), *((joint, "position") for joint in steering)),
        odometry_rate=rate,
        warnings=tuple(warnings),
    )


@gazebo_plugin("gz-sim-velocity-control-system")
def velocity_control_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-velocity-control-system`` to the twin's own controller of a base in the plane."""
    parameters = _gz_odometry(plugin) | {"enable_odom_tf": False}
    unused = ("link_name", "initial_linear", "initial_angular")
    return plugin.drive(
        PLANAR_MOVE,
        parameters,
        {"cmd_vel_unstamped": ("topic", "cmd_vel")},
        interfaces=PLANAR_INTERFACES,
        true_odometry=True,
        warnings=tuple(f"<{tag}> is not supported" for tag in unused if plugin.has(tag)),
    )


def _odometry_rate(plugin: DrivePlugin) -> float:
    """Return the rate at which a drive publishes its odometry (Hz)."""
    return as_rate(plugin.number("odom_publish_frequency", 50.0))


def _gz_odometry(plugin: DrivePlugin, rate: float = 0.0) -> dict[str, Any]:
    """Return the parameters of the odometry; a drive is updated at least at its rate (Hz)."""
    more = {"update_rate": rate} if rate > DEFAULT_UPDATE_RATE else {}
    return more | {
        "odom_frame_id": plugin.text("frame_id", "odom"),
        "base_frame_id": plugin.text("child_frame_id", plugin.description.root_link),
        "enable_odom_tf": True,
        "use_stamped_vel": False,
    }


def gz_limits(plugin: DrivePlugin, direction: str = "", above: str = "") -> dict[str, float]:
    """Return gz's limits of one direction; where it has only one bound, the other is infinite.

    Args:
        plugin: The plugin.
        direction: A part of the elements' names, which they may have.
        above: The element that they are in, with a ``/`` after it.
    """
    limits: dict[str, float] = {}
    lower_names = {"velocity": "min_velocity", "acceleration": "max_acceleration_reverse", "jerk": "min_jerk"}
    for what, lower_name in lower_names.items():
        bounds = []
        for side in ("min", "max"):
            tags = [f"{side}_{direction}_{what}"] if direction else []
            tags = [f"{above}{tag}" for tag in (*tags, f"{side}_{what}")]
            given = [plugin.number(tag, 0.0) for tag in tags if plugin.has(tag)]
            bounds.append(given[0] if given else None)
        if bounds != [None, None]:
            lower, upper = bounds
            limits[lower_name] = min(-inf if lower is None else lower, 0.0)
            limits[f"max_{what}"] = max(inf if upper is None else upper, 0.0)
    return limits


def _is_below(description: RobotDescription, joint: str, others: Iterable[str]) -> bool:
    """Tell whether a joint is below the link that one of the others moves."""
    joint_of = {each.child: each for each in description.joints}
    found = joint_of.get(description.joints_by_name[joint].parent)
    while found is not None:
        if found.name in others:
            return True
        found = joint_of.get(found.parent)
    return False
