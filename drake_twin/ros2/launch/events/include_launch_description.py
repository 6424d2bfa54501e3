"""Stand-ins for ``launch.events.include_launch_description``."""

from drake_twin.ros2.events import IncludeLaunchDescription

__all__ = ["IncludeLaunchDescription"]
