"""Starts a rover's controllers: first the one that publishes its joints' states, then the one that drives them."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, RegisterEventHandler
from launch.event_handlers import OnProcessExit
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def spawner(controller):
    robot_name = LaunchConfiguration("robot_name")
    return Node(
        package="controller_manager",
        executable="spawner",
        namespace=robot_name,
        arguments=[controller, "--controller-manager", ["/", robot_name, "/controller_manager"]],
        output="screen",
    )


def generate_launch_description():
    joint_states = spawner("joint_state_broadcaster")
    velocities = spawner("forward_velocity_controller")
    return LaunchDescription(
        [
            DeclareLaunchArgument("robot_name", default_value="rover", description="The rover's name"),
            joint_states,
            RegisterEventHandler(OnProcessExit(target_action=joint_states, on_exit=[velocities])),
        ]
    )
