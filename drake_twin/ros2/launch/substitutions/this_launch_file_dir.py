"""Stand-ins for ``launch.substitutions.this_launch_file_dir``."""

from drake_twin.ros2.substitutions import ThisLaunchFileDir

__all__ = ["ThisLaunchFileDir"]
