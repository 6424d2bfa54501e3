"""The arm in Gazebo with the controllers that MoveIt sends trajectories to."""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node

CONTROLLERS = ("joint_state_broadcaster", "joint_trajectory_controller", "gripper_controller")


def generate_launch_description():
    share = get_package_share_directory("arduinobot_description")
    parameters = os.path.join(share, "config", "arduinobot_trajectories.yaml")
    gazebo = PythonLaunchDescriptionSource(os.path.join(share, "launch", "gazebo.launch.py"))
    spawners = [
        Node(
            package="controller_manager",
            executable="spawner",
            arguments=[controller, "--param-file", parameters],
            output="screen",
        )
        for controller in CONTROLLERS
    ]
    return LaunchDescription([IncludeLaunchDescription(gazebo), *spawners])
