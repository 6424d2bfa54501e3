"""Stand-ins for ``launch_ros.actions.node``."""

from drake_twin.ros2.ros_actions import Node

__all__ = ["Node"]
