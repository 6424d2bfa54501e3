"""Stand-ins for ``launch.actions.append_environment_variable``."""

from drake_twin.ros2.actions import AppendEnvironmentVariable

__all__ = ["AppendEnvironmentVariable"]
