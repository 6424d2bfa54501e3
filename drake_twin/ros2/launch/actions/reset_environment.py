"""Stand-ins for ``launch.actions.reset_environment``."""

from drake_twin.ros2.actions import ResetEnvironment

__all__ = ["ResetEnvironment"]
