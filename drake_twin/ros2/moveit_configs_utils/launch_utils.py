"""``moveit_configs_utils.launch_utils``: parts of MoveIt's launch descriptions."""

from typing import Any

from drake_twin.ros2.launch.actions.declare_launch_argument import DeclareLaunchArgument
from drake_twin.ros2.launch.launch_description import LaunchDescription
from drake_twin.ros2.launch_ros.actions.node import Node


class DeclareBooleanLaunchArg(DeclareLaunchArgument):
    """Declares an argument that is true or false."""

    def __init__(self, name: str, *, default_value: Any = False, description: str | None = None, **kwargs: Any):
        super().__init__(name, default_value=str(default_value), description=description, **kwargs)


def add_debuggable_node(
    ld: LaunchDescription,
    package: str,
    executable: str,
    condition_name: str = "debug",
    commands_file: Any = None,
    extra_debug_args: Any = None,
    **kwargs: Any,
) -> None:
    """Add a node to a description."""
    ld.add_action(Node(package=package, executable=executable, **kwargs))
