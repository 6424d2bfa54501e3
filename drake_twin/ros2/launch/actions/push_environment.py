"""Stand-ins for ``launch.actions.push_environment``."""

from drake_twin.ros2.actions import PushEnvironment

__all__ = ["PushEnvironment"]
