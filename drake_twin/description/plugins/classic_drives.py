"""The drives among the plugins of Gazebo classic (``gazebo_plugins``), as controllers."""

from math import dist
from typing import Any

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
from drake_twin.description.wheel_geometry import wheel_centers, wheel_radius

_UNKNOWN = 1e12  # the covariance that classic plugins give to directions out of the plane


_SOURCES = {"encoder": 0, "world": 1}  # the words of ROS 1; the plugin of ROS 2 has the numbers


@gazebo_plugin("libgazebo_ros_diff_drive.so")
def gazebo_ros_diff_drive(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``libgazebo_ros_diff_drive.so`` to a diff_drive_controller."""
    left, right = plugin.joints("left_joint"), plugin.joints("right_joint")
    pairs = max(int(plugin.number("num_wheel_pairs", 1.0)), 1)
    if len(left) != pairs or len(right) != pairs:
        raise CannotWorkError(
            f"<num_wheel_pairs> is {pairs}, but there are {len(left)} left and {len(right)} right joints"
        )
    separations = plugin.numbers("wheel_separation")[:pairs] or (0.34,)
    diameters = plugin.numbers("wheel_diameter")[:pairs] or (0.15,)
    for tag, values in (("wheel_separation", separations), ("wheel_diameter", diameters)):
        if min(values) <= 0.0:
            raise plugin.error(f"<{tag}> is {min(values):g}, which is not above zero")
    rate = as_rate(plugin.number("update_rate", 100.0))
    parameters = _classic_odometry(plugin) | {
        "update_rate": rate,
        "left_wheel_names": list(left),
        "right_wheel_names": list(right),
        "wheel_separation": separations[0],
        "wheel_radius": 0.5 * diameters[0],
        "cmd_vel_timeout": 0.0,
        "publish_rate": rate,
        "velocity_rolling_window_size": 1,
        "tf_frame_prefix_enable": False,
    }
    acceleration = plugin.number("max_wheel_acceleration", 0.0)  # of the rim, m/s²
    if acceleration > 0.0:
        parameters["linear"] = {"x": {"max_acceleration": acceleration}}
        parameters["angular"] = {"z": {"max_acceleration": 2.0 * acceleration / separations[0]}}
    warnings = []
    if len({*separations}) > 1 or len({*diameters}) > 1:
        warnings.append("its pairs of wheels differ, but all are driven like the first")
    plugin.skip("publish_wheel_tf", "false", "0")
    plugin.skip("command_topic", "cmd_vel")  # the plugin of ROS 1 read these two
    plugin.skip("odometry_topic", "odom")
    odometry = plugin.flag("publish_odom", False)
    source = plugin.text("odometry_source", "1")
    if source in _SOURCES:
        read = f"it is read as {_SOURCES[source]}, and the plugin of ROS 2 knows 0 and 1 only"
        warnings.append(f"<odometry_source> is {source!r}: {read}")
    return plugin.drive(
        "diff_drive_controller/DiffDriveController",
        parameters,
        topics=plugin.ros_topics({"cmd_vel_unstamped": "cmd_vel", "odom": "odom" if odometry else None}),
        interfaces=tuple((joint, "velocity") for joint in (*left, *right)),
        efforts=dict.fromkeys((*left, *right), plugin.number("max_wheel_torque", 5.0)),
        true_odometry=_SOURCES.get(source) == 1
        or (source not in _SOURCES and plugin.number("odometry_source", 1.0) == 1),
        odometry_rate=rate,
        warnings=tuple(warnings),
    )


@gazebo_plugin("libgazebo_ros_ackermann_drive.so")
def gazebo_ros_ackermann_drive(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``libgazebo_ros_ackermann_drive.so`` to an ackermann_steering_controller."""
    names = ("front_right_joint", "front_left_joint", "rear_right_joint", "rear_left_joint")
    wheels = tuple(plugin.text(tag, tag) for tag in names)
    steering = tuple(plugin.text(tag, tag) for tag in ("right_steering_joint", "left_steering_joint"))
    plugin.check_joints((*wheels, *steering))
    front_right, front_left, rear_right, rear_left = wheel_centers(plugin.description, wheels)
    radius = wheel_radius(plugin.description, wheels[2])
    if radius is None:
        raise CannotWorkError(f"the radius is unknown: the wheel of joint {wheels[2]!r} has no cylinder or sphere")
    wheelbase = dist(0.5 * (front_right + front_left), 0.5 * (rear_right + rear_left))
    speed, rate = plugin.number("max_speed", 20.0), as_rate(plugin.number("update_rate", 100.0))
    parameters = _classic_odometry(plugin) | {
        "update_rate": rate,
        "traction_joints_names": list(wheels[2:]),
        "steering_joints_names": list(steering),
        "reference_timeout": FOR_EVER,
        "wheelbase": wheelbase,
        "traction_wheels_radius": radius,
        "traction_track_width": dist(rear_left, rear_right),
        "steering_track_width": dist(front_left, front_right),
        "velocity_rolling_window_size": 1,
        "linear": {"x": {"max_velocity": speed}},
        "largest_steering_angle": plugin.number("max_steer", 0.6),
        "angular_is_steering_angle": True,
    }
    odometry = plugin.flag("publish_odom", False)
    unused = ("publish_distance", "publish_steerangle")
    return plugin.drive(
        "ackermann_steering_controller/AckermannSteeringController",
        parameters,
        topics=plugin.ros_topics({"reference_unstamped": "cmd_vel", "odometry": "odom" if odometry else None}),
        interfaces=(*((joint, "velocity") for joint in wheels[2:]), *((joint, "position") for joint in steering)),
        true_odometry=True,
        odometry_rate=rate,
        warnings=tuple(f"<{tag}> is not supported" for tag in unused if plugin.flag(tag, False)),
    )


@gazebo_plugin("libgazebo_ros_planar_move.so")
def gazebo_ros_planar_move(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``libgazebo_ros_planar_move.so`` to the twin's own controller of a base in the plane."""
    rate = as_rate(plugin.number("publish_rate", 20.0))
    parameters = _classic_odometry(plugin) | {
        "publish_rate": rate,
        "enable_odom_tf": plugin.flag("publish_odom_tf", True),
    }
    odometry = plugin.flag("publish_odom", True)
    return plugin.drive(
        PLANAR_MOVE,
        parameters,
        topics=plugin.ros_topics({"cmd_vel_unstamped": "cmd_vel", "odom": "odom" if odometry else None}),
        interfaces=PLANAR_INTERFACES,
        true_odometry=True,
        odometry_rate=rate,
    )


def _classic_odometry(plugin: DrivePlugin) -> dict[str, Any]:
    covariance = [plugin.number("covariance_x", 1e-5), plugin.number("covariance_y", 1e-5)]
    covariance += [_UNKNOWN, _UNKNOWN, _UNKNOWN, plugin.number("covariance_yaw", 1e-3)]
    return {
        "odom_frame_id": plugin.text("odometry_frame", "odom"),
        "base_frame_id": plugin.text("robot_base_frame", "base_footprint"),
        "pose_covariance_diagonal": covariance,
        "twist_covariance_diagonal": covariance,
        "enable_odom_tf": plugin.flag("publish_odom_tf", False),
        "use_stamped_vel": False,
    }
