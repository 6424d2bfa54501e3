"""Stand-ins for ``launch.conditions.if_condition``."""

from drake_twin.ros2.conditions import IfCondition

__all__ = ["IfCondition"]
