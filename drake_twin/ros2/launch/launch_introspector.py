"""Stand-ins for ``launch.launch_introspector``."""

from drake_twin.ros2.launch_service import LaunchIntrospector

__all__ = ["LaunchIntrospector"]
