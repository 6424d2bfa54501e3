"""Stand-ins for ``launch_ros.actions.set_remap``."""

from drake_twin.ros2.ros_actions import SetRemap

__all__ = ["SetRemap"]
