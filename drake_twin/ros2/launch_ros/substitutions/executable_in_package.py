"""Stand-ins for ``launch_ros.substitutions.executable_in_package``."""

from drake_twin.ros2.substitutions import ExecutableInPackage

__all__ = ["ExecutableInPackage"]
