"""Stand-ins for ``launch.event_handlers.on_include_launch_description``."""

from drake_twin.ros2.event_handlers import OnIncludeLaunchDescription

__all__ = ["OnIncludeLaunchDescription"]
