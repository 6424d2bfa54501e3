"""The truth value of a condition's text."""

from drake_twin.ros2.launch.conditions.invalid_condition_expression_error import InvalidConditionExpressionError
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType

_TRUE = ("true", "1")
_FALSE = ("false", "0")


def evaluate_condition_expression(context: LaunchContext, expression: SomeSubstitutionsType) -> bool:
    """Return the truth value of text that says true, false, 1 or 0.

    Raises:
        InvalidConditionExpressionError: If it says something else.
    """
    text = context.perform_substitution(expression)
    word = text.strip().lower()
    if word in _TRUE or word in _FALSE:
        return word in _TRUE
    raise InvalidConditionExpressionError(
        f"the condition is {text!r}, which is neither true nor false", valid=[*_TRUE, *_FALSE]
    )
