"""Stand-ins for ``launch_ros.actions.lifecycle_transition``."""

from drake_twin.ros2.ros_actions import LifecycleTransition

__all__ = ["LifecycleTransition"]
