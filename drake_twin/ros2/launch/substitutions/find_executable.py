"""Stand-ins for ``launch.substitutions.find_executable``."""

from drake_twin.ros2.substitutions import FindExecutable

__all__ = ["FindExecutable"]
