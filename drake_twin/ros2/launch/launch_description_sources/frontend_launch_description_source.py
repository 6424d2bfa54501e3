"""The source of an XML or YAML launch file."""

from drake_twin.ros2.launch.launch_description_sources.any_launch_description_source import AnyLaunchDescriptionSource

__all__ = ["FrontendLaunchDescriptionSource"]

FrontendLaunchDescriptionSource = AnyLaunchDescriptionSource
