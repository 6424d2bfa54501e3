"""ROS programs that the twin has itself, as rclpy nodes: launch files start them where the workspace has no other."""

from pathlib import Path

from drake_twin.description.python_programs import PythonProgram

_FOLDER = Path(__file__).parents[1] / "nodes" / "programs"
# Package → executable, or plugin of a container → the module here and its function.
_PROGRAMS = {
    "joint_state_publisher": {"joint_state_publisher": ("joint_state_publisher", "main")},
    "depthimage_to_laserscan": {
        "depthimage_to_laserscan_node": ("depthimage_to_laserscan", "main"),
        "depthimage_to_laserscan::DepthImageToLaserScanROS": ("depthimage_to_laserscan", "main"),
    },
    "irobot_create_nodes": {
        "motion_control": ("create3_nodes", "motion_control"),
        "ui_mgr": ("create3_nodes", "ui_mgr"),
    },
    "moveit_ros_move_group": {"move_group": ("move_group", "main")},
    "image_proc": {"rectify_node": ("rectify_node", "main"), "image_proc::RectifyNode": ("rectify_node", "main")},
    "pointcloud_to_laserscan": {
        "laserscan_to_pointcloud_node": ("pointcloud_to_laserscan", "cloud"),
        "pointcloud_to_laserscan_node": ("pointcloud_to_laserscan", "scan"),
        "pointcloud_to_laserscan::LaserScanToPointCloudNode": ("pointcloud_to_laserscan", "cloud"),
        "pointcloud_to_laserscan::PointCloudToLaserScanNode": ("pointcloud_to_laserscan", "scan"),
    },
    "robot_localization": {"ekf_node": ("ekf_node", "main")},
    "teleop_twist_keyboard": {"teleop_twist_keyboard": ("teleop_twist_keyboard", "main")},
    "teleop_twist_joy": {
        "teleop_node": ("teleop_twist_joy", "main"),
        "teleop_twist_joy::TeleopTwistJoy": ("teleop_twist_joy", "main"),
    },
    "twist_mux": {"twist_mux": ("twist_mux", "main")},
    "topic_tools": {
        "mux": ("topic_mux", "main"),
        "delay": ("topic_tools", "delay"),
        "topic_tools::DelayNode": ("topic_tools", "delay"),
        "drop": ("topic_tools", "drop"),
        "topic_tools::DropNode": ("topic_tools", "drop"),
        "relay": ("topic_tools", "relay"),
        "topic_tools::RelayNode": ("topic_tools", "relay"),
        "throttle": ("topic_tools", "throttle"),
        "topic_tools::ThrottleNode": ("topic_tools", "throttle"),
    },
    "turtlesim": {
        "mimic": ("turtlesim_node", "mimic"),
        "turtle_teleop_key": ("turtle_teleop_key", "main"),
        "turtlesim_node": ("turtlesim_node", "main"),
    },
    "twist_stamper": {
        "twist_stamper": ("twist_stamper", "stamp"),
        "twist_unstamper": ("twist_stamper", "unstamp"),
    },
}


def built_in_programs(package: str) -> dict[str, PythonProgram]:
    """Return the programs of a ROS package that the twin has itself, by their executables' and plugins' names."""
    return {
        executable: PythonProgram(_FOLDER / f"{module}.py", module, function, _FOLDER)
        for executable, (module, function) in _PROGRAMS.get(package, {}).items()
    }
