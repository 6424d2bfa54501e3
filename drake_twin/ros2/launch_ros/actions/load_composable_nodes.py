"""Stand-ins for ``launch_ros.actions.load_composable_nodes``."""

from drake_twin.ros2.ros_actions import LoadComposableNodes

__all__ = ["LoadComposableNodes"]
