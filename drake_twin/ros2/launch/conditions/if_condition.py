"""Conditions that hold if their text says true, or false."""

from drake_twin.ros2.launch.condition import Condition
from drake_twin.ros2.launch.conditions.evaluate_condition_expression_impl import evaluate_condition_expression
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions


class IfCondition(Condition):
    """Holds if its text says true (or 1)."""

    def __init__(self, predicate_expression: SomeSubstitutionsType):
        super().__init__()
        if isinstance(predicate_expression, bool):
            predicate_expression = str(predicate_expression)
        self._expression = normalize_to_list_of_substitutions(predicate_expression)

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether the text says true."""
        return evaluate_condition_expression(context, self._expression)


class UnlessCondition(IfCondition):
    """Holds if its text says false (or 0)."""

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether the text says false."""
        return not super().evaluate(context)
