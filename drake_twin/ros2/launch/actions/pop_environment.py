"""Stand-ins for ``launch.actions.pop_environment``."""

from drake_twin.ros2.actions import PopEnvironment

__all__ = ["PopEnvironment"]
