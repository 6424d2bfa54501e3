"""Stand-ins for ``launch_ros.actions.push_ros_namespace``."""

from drake_twin.ros2.ros_actions import PushRosNamespace
from drake_twin.ros2.ros_actions import PushRosNamespace as PushROSNamespace

__all__ = ["PushROSNamespace", "PushRosNamespace"]
