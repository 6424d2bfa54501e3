"""Stand-ins for ``launch_ros.actions.composable_node_container``."""

from drake_twin.ros2.ros_actions import ComposableNodeContainer

__all__ = ["ComposableNodeContainer"]
