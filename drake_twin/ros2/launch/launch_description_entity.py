"""Stand-ins for ``launch.launch_description_entity``."""

from drake_twin.ros2.entity import LaunchDescriptionEntity

__all__ = ["LaunchDescriptionEntity"]
