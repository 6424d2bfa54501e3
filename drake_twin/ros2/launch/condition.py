"""Stand-ins for ``launch.condition``."""

from drake_twin.ros2.conditions import Condition

__all__ = ["Condition"]
