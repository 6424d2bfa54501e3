"""Stand-ins for ``launch.launch_description``."""

from drake_twin.ros2.entity import LaunchDescription

__all__ = ["LaunchDescription"]
