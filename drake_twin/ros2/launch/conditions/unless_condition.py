"""Stand-ins for ``launch.conditions.unless_condition``."""

from drake_twin.ros2.conditions import UnlessCondition

__all__ = ["UnlessCondition"]
