"""Conditions of actions: whether they are executed."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from drake_twin.errors import InputError
from drake_twin.ros2.substitution import SomeSubstitutionsType, normalize_to_list_of_substitutions, perform

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext

_TRUE = ("true", "1")
_FALSE = ("false", "0")


class InvalidConditionExpressionError(InputError):
    """A condition's text that is neither true nor false."""


class Condition:
    """A condition of a launch file.

    Args:
        predicate: called with the context; True if the action is to be executed.
    """

    def __init__(self, *, predicate: Callable[[Any], bool] | None = None):
        self._predicate = predicate

    def evaluate(self, context: LaunchContext) -> bool:
        """Whether the condition holds now."""
        return self._predicate is not None and bool(self._predicate(context))

    def describe(self) -> str:
        """The condition in a few words."""
        return type(self).__name__


def evaluate_condition_expression(context: LaunchContext, expression: SomeSubstitutionsType) -> bool:
    """Text that says true, false, 1 or 0.

    Raises:
        InvalidConditionExpressionError: it says something else.
    """
    text = perform(context, expression)
    word = text.strip().lower()
    if word in _TRUE or word in _FALSE:
        return word in _TRUE
    raise InvalidConditionExpressionError(
        f"the condition is {text!r}, which is neither true nor false",
        valid=[*_TRUE, *_FALSE],
    )


class IfCondition(Condition):
    """Holds if its text says true (or 1)."""

    def __init__(self, predicate_expression: SomeSubstitutionsType):
        super().__init__()
        self._expression = normalize_to_list_of_substitutions(_boolean_as_text(predicate_expression))

    def evaluate(self, context: LaunchContext) -> bool:
        """Whether the text says true."""
        return evaluate_condition_expression(context, self._expression)


class UnlessCondition(IfCondition):
    """Holds if its text says false (or 0)."""

    def evaluate(self, context: LaunchContext) -> bool:
        """Whether the text says false."""
        return not super().evaluate(context)


class LaunchConfigurationEquals(Condition):
    """Holds if a launch configuration has a value; with None, if there is no such configuration."""

    def __init__(self, launch_configuration_name: str, expected_value: SomeSubstitutionsType | None):
        super().__init__()
        self._name = launch_configuration_name
        self._expected = expected_value

    def evaluate(self, context: LaunchContext) -> bool:
        """Whether the configuration has the value."""
        value = context.launch_configurations.get(self._name)
        expected = None if self._expected is None else perform(context, self._expected)
        return bool(value == expected)


class LaunchConfigurationNotEquals(LaunchConfigurationEquals):
    """Holds if a launch configuration has another value."""

    def evaluate(self, context: LaunchContext) -> bool:
        """Whether the configuration has another value."""
        return not super().evaluate(context)


def _boolean_as_text(expression: Any) -> Any:
    return str(expression) if isinstance(expression, bool) else expression
