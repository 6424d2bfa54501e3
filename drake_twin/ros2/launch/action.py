"""Stand-ins for ``launch.action``."""

from drake_twin.ros2.entity import Action

__all__ = ["Action"]
