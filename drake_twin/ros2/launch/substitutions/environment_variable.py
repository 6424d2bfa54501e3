"""Stand-ins for ``launch.substitutions.environment_variable``."""

from drake_twin.ros2.substitutions import EnvironmentVariable

__all__ = ["EnvironmentVariable"]
