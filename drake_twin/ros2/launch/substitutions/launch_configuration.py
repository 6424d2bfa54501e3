"""Stand-ins for ``launch.substitutions.launch_configuration``."""

from drake_twin.ros2.substitutions import LaunchConfiguration

__all__ = ["LaunchConfiguration"]
