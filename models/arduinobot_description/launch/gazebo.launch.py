"""The arm in Gazebo: its description, an empty world, the arm spawned into it, and the clock."""

import os
from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, SetEnvironmentVariable
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import Command, LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description():
    share = get_package_share_directory("arduinobot_description")
    gz_launch = os.path.join(get_package_share_directory("ros_gz_sim"), "launch", "gz_sim.launch.py")
    description = ParameterValue(Command(["xacro ", LaunchConfiguration("model")]), value_type=str)

    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "model",
                default_value=os.path.join(share, "urdf", "arduinobot.urdf.xacro"),
                description="Absolute path of the robot's xacro file",
            ),
            # Gazebo finds package://arduinobot_description/… below the folder that holds the package.
            SetEnvironmentVariable("GZ_SIM_RESOURCE_PATH", str(Path(share).parent.resolve())),
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[{"robot_description": description, "use_sim_time": True}],
            ),
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(gz_launch),
                launch_arguments={"gz_args": " -v 4 -r empty.sdf "}.items(),
            ),
            Node(
                package="ros_gz_sim",
                executable="create",
                arguments=["-topic", "robot_description", "-name", "arduinobot"],
                output="screen",
            ),
            Node(
                package="ros_gz_bridge",
                executable="parameter_bridge",
                arguments=["/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock"],
            ),
        ]
    )
