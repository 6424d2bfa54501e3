"""Stand-ins for ``launch.actions.unset_environment_variable``."""

from drake_twin.ros2.actions import UnsetEnvironmentVariable

__all__ = ["UnsetEnvironmentVariable"]
