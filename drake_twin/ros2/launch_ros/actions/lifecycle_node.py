"""Stand-ins for ``launch_ros.actions.lifecycle_node``."""

from drake_twin.ros2.ros_actions import LifecycleNode

__all__ = ["LifecycleNode"]
