"""The rover with its lidar in the room, driven by cmd_vel: what Nav2 needs of a robot."""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, OpaqueFunction
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterFile

ROVER = "rover"


def included(file, **arguments):
    source = os.path.join(get_package_share_directory("rover_gazebo"), "launch", file)
    return IncludeLaunchDescription(PythonLaunchDescriptionSource(source), launch_arguments=arguments.items())


def spawners(context, drive_parameters):
    more = LaunchConfiguration("drive_parameters").perform(context)
    files = ["--param-file", str(drive_parameters.evaluate(context)), "--param-file", more]
    return [
        Node(
            package="controller_manager",
            executable="spawner",
            namespace=ROVER,
            arguments=[controller, "--controller-manager", f"/{ROVER}/controller_manager", *words],
            output="screen",
        )
        for controller, words in (("joint_state_broadcaster", []), ("drive_controller", files))
    ]


def generate_launch_description():
    share = get_package_share_directory("rover_navigation")
    file = os.path.join(get_package_share_directory("rover_description"), "config", "rover_drive.yaml")
    # The filled-in file is deleted with its ParameterFile, which must outlive the function that starts the spawner.
    drive_parameters = ParameterFile(file, allow_substs=True)
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "drive_parameters",
                default_value=os.path.join(share, "config", "odometry.yaml"),
                description="Parameters of drive_controller, beside those of rover_drive.yaml",
            ),
            included("start_world.launch.py", world=os.path.join(share, "worlds", "room.sdf")),
            included("robot_state_publisher.launch.py", robot_name=ROVER, lidar="true"),
            included("spawn_in_gazebo.launch.py", robot_name=ROVER, x="0.0", y="0.0", z="0.13", yaw="0.0"),
            Node(
                package="ros_gz_bridge",
                executable="parameter_bridge",
                name="scan_bridge",
                arguments=[f"/{ROVER}/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan"],
                output="screen",
            ),
            OpaqueFunction(function=spawners, args=[drive_parameters]),
        ]
    )
