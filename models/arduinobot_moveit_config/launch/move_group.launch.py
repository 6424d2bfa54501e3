"""MoveIt's move_group for the arm, by the simulation's clock."""

from launch import LaunchDescription
from launch_ros.actions import Node
from moveit_configs_utils import MoveItConfigsBuilder


def generate_launch_description():
    builder = MoveItConfigsBuilder("arduinobot", package_name="arduinobot_moveit_config")
    config = (
        builder.planning_pipelines(pipelines=["ompl"])
        .planning_scene_monitor(publish_robot_description_semantic=True)
        .to_moveit_configs()
    )
    return LaunchDescription(
        [
            Node(
                package="moveit_ros_move_group",
                executable="move_group",
                parameters=[config.to_dict(), {"use_sim_time": True}],
                output="screen",
            )
        ]
    )
