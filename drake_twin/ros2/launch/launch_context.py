"""Stand-ins for ``launch.launch_context``."""

from drake_twin.ros2.context import LaunchContext

__all__ = ["LaunchContext"]
