"""Stand-ins for ``launch.actions.set_environment_variable``."""

from drake_twin.ros2.actions import SetEnvironmentVariable

__all__ = ["SetEnvironmentVariable"]
