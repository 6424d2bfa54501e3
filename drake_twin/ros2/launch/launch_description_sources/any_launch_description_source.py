"""Stand-ins for ``launch.launch_description_sources.any_launch_description_source``."""

from drake_twin.ros2.include import AnyLaunchDescriptionSource

__all__ = ["AnyLaunchDescriptionSource"]
