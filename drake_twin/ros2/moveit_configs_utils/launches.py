"""``moveit_configs_utils.launches``: the launch descriptions of a MoveIt package's files."""

from pathlib import Path
from typing import Any

from drake_twin.ros2.launch.actions.declare_launch_argument import DeclareLaunchArgument
from drake_twin.ros2.launch.actions.include_launch_description import IncludeLaunchDescription
from drake_twin.ros2.launch.conditions.if_condition import IfCondition
from drake_twin.ros2.launch.launch_description import LaunchDescription
from drake_twin.ros2.launch.launch_description_sources.python_launch_description_source import (
    PythonLaunchDescriptionSource,
)
from drake_twin.ros2.launch.substitutions.launch_configuration import LaunchConfiguration
from drake_twin.ros2.launch_ros.actions.node import Node
from drake_twin.ros2.moveit_configs_utils.launch_utils import DeclareBooleanLaunchArg
from drake_twin.ros2.moveit_configs_utils.moveit_configs_builder import MoveItConfigs


def generate_rsp_launch(moveit_config: MoveItConfigs) -> LaunchDescription:
    """Return a description with the robot_state_publisher."""
    frequency = {"publish_frequency": LaunchConfiguration("publish_frequency")}
    return LaunchDescription(
        [
            DeclareLaunchArgument("publish_frequency", default_value="15.0"),
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[moveit_config.robot_description, frequency],
            ),
        ]
    )


def generate_moveit_rviz_launch(moveit_config: MoveItConfigs) -> LaunchDescription:
    """Return a description with RViz."""
    file = str(Path(moveit_config.package_path or "") / "config" / "moveit.rviz")
    return LaunchDescription(
        [
            DeclareBooleanLaunchArg("debug"),
            DeclareLaunchArgument("rviz_config", default_value=file),
            Node(package="rviz2", executable="rviz2", arguments=["-d", LaunchConfiguration("rviz_config")]),
        ]
    )


def generate_setup_assistant_launch(moveit_config: MoveItConfigs) -> LaunchDescription:
    """Return a description with MoveIt's setup assistant."""
    words = [f"--config_pkg={moveit_config.package_path}"]
    node = Node(package="moveit_setup_assistant", executable="moveit_setup_assistant", arguments=words)
    return LaunchDescription([DeclareBooleanLaunchArg("debug"), node])


def generate_static_virtual_joint_tfs_launch(moveit_config: MoveItConfigs) -> LaunchDescription:
    """Return a description with a static transform for each virtual joint of the SRDF."""
    from lxml import etree

    description = LaunchDescription()
    text = next(iter(moveit_config.robot_description_semantic.values()), "<robot/>")
    root = etree.fromstring(text.encode()) if isinstance(text, str) else etree.Element("robot")
    for index, joint in enumerate(root.iter("virtual_joint")):
        frames = [joint.get("parent_frame", ""), joint.get("child_link", "")]
        description.add_action(
            Node(
                package="tf2_ros",
                executable="static_transform_publisher",
                name=f"static_transform_publisher{index}",
                arguments=["--frame-id", frames[0], "--child-frame-id", frames[1]],
            )
        )
    return description


def generate_spawn_controllers_launch(moveit_config: MoveItConfigs) -> LaunchDescription:
    """Return a description that spawns MoveIt's controllers and the joint_state_broadcaster."""
    manager = moveit_config.trajectory_execution.get("moveit_simple_controller_manager", {})
    names = [*manager.get("controller_names", []), "joint_state_broadcaster"]
    return LaunchDescription(
        [Node(package="controller_manager", executable="spawner", arguments=[name]) for name in names]
    )


def generate_warehouse_db_launch(moveit_config: MoveItConfigs) -> LaunchDescription:
    """Return a description with the warehouse's database."""
    return LaunchDescription(
        [
            DeclareLaunchArgument("moveit_warehouse_port", default_value="33829"),
            DeclareLaunchArgument("moveit_warehouse_host", default_value="localhost"),
            Node(package="warehouse_ros_mongo", executable="mongo_wrapper_ros.py"),
        ]
    )


def generate_move_group_launch(moveit_config: MoveItConfigs) -> LaunchDescription:
    """Return a description with ``move_group``."""
    return LaunchDescription(
        [
            DeclareBooleanLaunchArg("debug"),
            DeclareBooleanLaunchArg("allow_trajectory_execution", default_value=True),
            DeclareBooleanLaunchArg("publish_monitored_planning_scene", default_value=True),
            DeclareLaunchArgument("capabilities", default_value=""),
            DeclareLaunchArgument("disable_capabilities", default_value=""),
            DeclareBooleanLaunchArg("monitor_dynamics"),
            Node(package="moveit_ros_move_group", executable="move_group"),
        ]
    )


def generate_demo_launch(moveit_config: MoveItConfigs, launch_package_path: Any = None) -> LaunchDescription:
    """Return a description with all of the above, and a ros2_control_node."""
    package = Path(moveit_config.package_path or "")
    launch = Path(launch_package_path or package) / "launch"

    def include(name: str, argument: str | None = None) -> list[IncludeLaunchDescription]:
        if not (launch / name).exists():
            return []
        condition = None if argument is None else IfCondition(LaunchConfiguration(argument))
        source = PythonLaunchDescriptionSource(str(launch / name))
        return [IncludeLaunchDescription(source, condition=condition)]

    return LaunchDescription(
        [
            DeclareBooleanLaunchArg("db"),
            DeclareBooleanLaunchArg("debug"),
            DeclareBooleanLaunchArg("use_rviz", default_value=True),
            *include("static_virtual_joint_tfs.launch.py"),
            *include("rsp.launch.py"),
            *include("move_group.launch.py"),
            *include("moveit_rviz.launch.py", "use_rviz"),
            *include("warehouse_db.launch.py", "db"),
            Node(
                package="controller_manager",
                executable="ros2_control_node",
                parameters=[moveit_config.robot_description, str(package / "config" / "ros2_controllers.yaml")],
            ),
            *include("spawn_controllers.launch.py"),
        ]
    )
