"""The world, the simulator and the clock; robots are spawned into it by other files."""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, SetEnvironmentVariable
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def with_folder(variable, folder):
    """A search path with one more folder at its end."""
    return os.pathsep.join(part for part in (os.environ.get(variable, ""), folder) if part)


def generate_launch_description():
    share = get_package_share_directory("rover_gazebo")
    packages = os.path.dirname(get_package_share_directory("rover_description"))
    gz_launch = os.path.join(get_package_share_directory("ros_gz_sim"), "launch", "gz_sim.launch.py")

    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "world",
                default_value=os.path.join(share, "worlds", "plain.sdf"),
                description="Path of the SDF world",
            ),
            SetEnvironmentVariable("GZ_SIM_RESOURCE_PATH", with_folder("GZ_SIM_RESOURCE_PATH", packages)),
            SetEnvironmentVariable("GAZEBO_MODEL_PATH", with_folder("GAZEBO_MODEL_PATH", packages)),
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(gz_launch),
                launch_arguments={"gz_args": ["-r ", LaunchConfiguration("world")]}.items(),
            ),
            Node(
                package="ros_gz_bridge",
                executable="parameter_bridge",
                arguments=["/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock"],
                output="screen",
            ),
        ]
    )
