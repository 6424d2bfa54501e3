"""Stand-ins for ``launch.actions.for_loop``."""

from drake_twin.ros2.actions import ForEach, ForLoop

__all__ = ["ForEach", "ForLoop"]
