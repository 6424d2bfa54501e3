"""Stand-ins for ``launch_ros.descriptions.composable_node``."""

from drake_twin.ros2.ros_actions import ComposableLifecycleNode, ComposableNode

__all__ = ["ComposableLifecycleNode", "ComposableNode"]
