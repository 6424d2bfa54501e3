"""Stand-ins for ``launch.conditions.invalid_condition_expression_error``."""

from drake_twin.ros2.conditions import InvalidConditionExpressionError

__all__ = ["InvalidConditionExpressionError"]
