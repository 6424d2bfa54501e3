"""The systems of gz-sim that publish where a model is, as controllers that command nothing."""

from drake_twin.description.gazebo_drive import (
    ODOMETRY_PUBLISHER,
    POSE_PUBLISHER,
    CannotWorkError,
    DrivePlugin,
    GazeboDrive,
    as_rate,
    gazebo_plugin,
)

_MOST_NOISE = 1e6  # m, rad and their rates


@gazebo_plugin("gz-sim-odometry-publisher-system")
def odometry_publisher_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-odometry-publisher-system`` to the twin's own controller of this kind."""
    description = plugin.description
    dimensions = plugin.number("dimensions", 2)
    if dimensions not in (2, 3):
        raise CannotWorkError(f"<dimensions> is {dimensions:g}, which is neither 2 nor 3")
    base = "base_footprint" if "base_footprint" in description.links else description.root_link
    noise = plugin.number("gaussian_noise", 0.0)
    if not 0.0 <= noise <= _MOST_NOISE:
        raise plugin.error(f"<gaussian_noise> is {noise:g}, which is not from 0 to {_MOST_NOISE:g}")
    parameters = {
        "odom_frame": plugin.text("odom_frame", "odom"),
        "robot_base_frame": plugin.text("robot_base_frame", base),
        "dimensions": int(dimensions),
        "xyz_offset": list(plugin.vector("xyz_offset")),
        "rpy_offset": list(plugin.vector("rpy_offset")),
        "gaussian_noise": noise,
        "tf_frame_prefix_enable": not plugin.has("odom_frame"),
        "update_rate": as_rate(plugin.number("odom_publish_frequency", 50.0)),
    }
    names = {
        "odom": ("odom_topic", "odometry"),
        "odom_with_covariance": ("odom_covariance_topic", "odometry_with_covariance"),
        "tf_odometry": ("tf_topic", "pose"),
    }
    return plugin.drive(
        ODOMETRY_PUBLISHER,
        parameters,
        names,
        warnings=("<gaussian_noise> is in the covariances, and not in the values",) if noise else (),
    )


@gazebo_plugin("gz-sim-pose-publisher-system")
def pose_publisher_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-pose-publisher-system`` to the twin's own controller of this kind."""
    nested = plugin.flag("publish_nested_model_pose", False)
    parameters = {
        "publish_link_pose": plugin.flag("publish_link_pose", True),
        "publish_model_pose": plugin.flag("publish_model_pose", nested) and nested,  # as gz-sim reads the two
        "update_rate": as_rate(plugin.number("update_frequency", -1.0)),
    }
    others = ("publish_visual_pose", "publish_collision_pose", "publish_sensor_pose")
    warnings = [f"<{tag}> is not supported" for tag in others if plugin.flag(tag, False)]
    if not plugin.flag("use_pose_vector_msg", False):
        warnings.append("all poses come in one TFMessage, as with <use_pose_vector_msg>")
    if plugin.flag("static_publisher", False):
        warnings.append("<static_publisher>: the poses that stay the same are on the topic of the others")
    plugin.has("static_update_frequency")
    return plugin.drive(
        POSE_PUBLISHER,
        parameters,
        topics={"pose": "pose"},
        gz_topics={"pose": "/model/{model}/pose"},
        warnings=tuple(warnings),
    )
