"""Stand-ins for ``launch.substitutions.launch_log_dir``."""

from drake_twin.ros2.substitutions import LaunchLogDir

__all__ = ["LaunchLogDir"]
