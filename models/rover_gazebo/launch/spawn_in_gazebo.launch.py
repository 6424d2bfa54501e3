"""Puts a rover, whose description is published already, into the world."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

POSE = {"x": "0.0", "y": "0.0", "z": "0.13", "roll": "0.0", "pitch": "0.0", "yaw": "0.0"}  # m, rad
OPTIONS = {"x": "-x", "y": "-y", "z": "-z", "roll": "-R", "pitch": "-P", "yaw": "-Y"}


def spawn(context):
    robot_name = LaunchConfiguration("robot_name").perform(context)
    words = ["-name", robot_name, "-topic", f"/{robot_name}_robot_description"]
    for name, option in OPTIONS.items():
        words += [option, LaunchConfiguration(name).perform(context)]
    return [Node(package="ros_gz_sim", executable="create", arguments=words, output="screen")]


def generate_launch_description():
    return LaunchDescription(
        [
            DeclareLaunchArgument("robot_name", default_value="rover", description="The rover's name"),
            *[DeclareLaunchArgument(name, default_value=value) for name, value in POSE.items()],
            OpaqueFunction(function=spawn),
        ]
    )
