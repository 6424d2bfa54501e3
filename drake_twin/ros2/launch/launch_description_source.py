"""Stand-ins for ``launch.launch_description_source``."""

from drake_twin.ros2.include import LaunchDescriptionSource

__all__ = ["LaunchDescriptionSource"]
