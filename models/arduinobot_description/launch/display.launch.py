"""The arm to look at, without physics: a slider for each joint, and RViz."""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import Command, LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description():
    share = get_package_share_directory("arduinobot_description")
    description = ParameterValue(Command(["xacro ", LaunchConfiguration("model")]), value_type=str)

    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "model",
                default_value=os.path.join(share, "urdf", "arduinobot.urdf.xacro"),
                description="Absolute path of the robot's xacro file",
            ),
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[{"robot_description": description}],
            ),
            Node(package="joint_state_publisher_gui", executable="joint_state_publisher_gui"),
            Node(package="rviz2", executable="rviz2", name="rviz2", arguments=["-f", "world"], output="screen"),
        ]
    )
