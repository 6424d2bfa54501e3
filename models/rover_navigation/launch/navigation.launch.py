"""The nodes of Nav2 that take the rover of simulation.launch.py to a pose in the room, by the simulation's clock."""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch_ros.actions import Node

# Node: its package; in the order in which they become active.
NODES = {
    "map_server": "nav2_map_server",
    "amcl": "nav2_amcl",
    "controller_server": "nav2_controller",
    "planner_server": "nav2_planner",
    "behavior_server": "nav2_behaviors",
    "velocity_smoother": "nav2_velocity_smoother",
    "collision_monitor": "nav2_collision_monitor",
    "bt_navigator": "nav2_bt_navigator",
}
# The commands' way: these publish cmd_vel_nav, which is smoothed and watched before it comes to the drive.
COMMANDING = ("controller_server", "behavior_server", "velocity_smoother")


def generate_launch_description():
    share = get_package_share_directory("rover_navigation")
    file = os.path.join(share, "config", "nav2.yaml")
    map_file = os.path.join(share, "maps", "room.yaml")
    nodes = [
        Node(
            package=package,
            executable=name,
            name=name,
            parameters=[file, {"use_sim_time": True, **({"yaml_filename": map_file} if name == "map_server" else {})}],
            remappings=[("cmd_vel", "cmd_vel_nav")] if name in COMMANDING else [],
            output="screen",
        )
        for name, package in NODES.items()
    ]
    manager = Node(
        package="nav2_lifecycle_manager",
        executable="lifecycle_manager",
        name="lifecycle_manager",
        parameters=[{"use_sim_time": True, "autostart": True, "node_names": list(NODES)}],
        output="screen",
    )
    return LaunchDescription([*nodes, manager])
