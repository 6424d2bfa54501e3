"""A rover's odometry frame, fixed at the world's origin."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    robot_name = LaunchConfiguration("robot_name")
    return LaunchDescription(
        [
            DeclareLaunchArgument("robot_name", default_value="rover", description="The rover's name"),
            Node(
                package="tf2_ros",
                executable="static_transform_publisher",
                name="static_odom_to_world",
                namespace=robot_name,
                arguments=["--frame-id", "world", "--child-frame-id", [robot_name, "_odom"]],
                parameters=[{"use_sim_time": True}],
            ),
        ]
    )
