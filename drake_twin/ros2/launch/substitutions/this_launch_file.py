"""Stand-ins for ``launch.substitutions.this_launch_file``."""

from drake_twin.ros2.substitutions import ThisLaunchFile

__all__ = ["ThisLaunchFile"]
