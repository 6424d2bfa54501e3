"""Starts a rover's controllers: the one that publishes its joints' states, then the ones that drive them.

drive_controller, which drives the rover by cmd_vel, stays inactive: it commands the same wheels as
forward_velocity_controller. To switch: ros2 control switch_controllers -c /rover/controller_manager
--deactivate forward_velocity_controller --activate drive_controller
"""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, RegisterEventHandler
from launch.event_handlers import OnProcessExit
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterFile


def spawner(controller, *options):
    robot_name = LaunchConfiguration("robot_name")
    return Node(
        package="controller_manager",
        executable="spawner",
        namespace=robot_name,
        arguments=[controller, "--controller-manager", ["/", robot_name, "/controller_manager"], *options],
        output="screen",
    )


def start(context, drive_parameters):
    joint_states = spawner("joint_state_broadcaster")
    velocities = spawner("forward_velocity_controller")
    # The drive's file names the wheels with $(var robot_name), which is filled in here.
    drive = spawner("drive_controller", "--inactive", "--param-file", str(drive_parameters.evaluate(context)))
    return [
        joint_states,
        RegisterEventHandler(OnProcessExit(target_action=joint_states, on_exit=[velocities])),
        RegisterEventHandler(OnProcessExit(target_action=velocities, on_exit=[drive])),
    ]


def generate_launch_description():
    file = os.path.join(get_package_share_directory("rover_description"), "config", "rover_drive.yaml")
    # The filled-in file is deleted with its ParameterFile, which must outlive the function that starts the spawner.
    drive_parameters = ParameterFile(file, allow_substs=True)
    return LaunchDescription(
        [
            DeclareLaunchArgument("robot_name", default_value="rover", description="The rover's name"),
            OpaqueFunction(function=start, args=[drive_parameters]),
        ]
    )
