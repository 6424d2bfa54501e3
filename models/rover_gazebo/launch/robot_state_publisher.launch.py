"""A rover's description and its frames, under the rover's own name."""

import os

import xacro
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterFile


def start(context):
    robot_name = LaunchConfiguration("robot_name").perform(context)
    share = get_package_share_directory("rover_description")
    # The controllers' file names the joints with $(var robot_name), which is filled in here.
    controllers = ParameterFile(os.path.join(share, "config", "rover_controllers.yaml"), allow_substs=True)
    description = xacro.process_file(
        os.path.join(share, "urdf", "rover.urdf.xacro"),
        mappings={
            "robot_name": robot_name,
            "controllers": str(controllers.evaluate(context)),
            "lidar": LaunchConfiguration("lidar").perform(context),
        },
    )
    return [
        Node(
            package="robot_state_publisher",
            executable="robot_state_publisher",
            namespace=robot_name,
            parameters=[{"robot_description": description.toxml(), "use_sim_time": True}],
            remappings=[
                ("robot_description", f"/{robot_name}_robot_description"),
                ("joint_states", f"/{robot_name}/joint_states"),
            ],
            output="screen",
        )
    ]


def generate_launch_description():
    return LaunchDescription(
        [
            DeclareLaunchArgument("robot_name", default_value="rover", description="The rover's name"),
            DeclareLaunchArgument("lidar", default_value="false", description="Whether it has a lidar"),
            OpaqueFunction(function=start),
        ]
    )
