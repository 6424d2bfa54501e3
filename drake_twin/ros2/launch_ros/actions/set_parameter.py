"""Stand-ins for ``launch_ros.actions.set_parameter``."""

from drake_twin.ros2.ros_actions import SetParameter

__all__ = ["SetParameter"]
