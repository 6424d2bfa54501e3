"""Stand-ins for ``launch.conditions.evaluate_condition_expression_impl``."""

from drake_twin.ros2.conditions import evaluate_condition_expression

__all__ = ["evaluate_condition_expression"]
