"""Stand-ins for ``launch.actions.include_launch_description``."""

from drake_twin.ros2.include import IncludeLaunchDescription

__all__ = ["IncludeLaunchDescription"]
