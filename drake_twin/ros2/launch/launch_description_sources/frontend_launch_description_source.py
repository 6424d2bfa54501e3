"""Stand-ins for ``launch.launch_description_sources.frontend_launch_description_source``."""

from drake_twin.ros2.include import FrontendLaunchDescriptionSource

__all__ = ["FrontendLaunchDescriptionSource"]
