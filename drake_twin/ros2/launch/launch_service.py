"""Stand-ins for ``launch.launch_service``."""

from drake_twin.ros2.launch_service import LaunchService

__all__ = ["LaunchService"]
