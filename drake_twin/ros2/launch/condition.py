"""Conditions of actions: whether they are executed."""

from collections.abc import Callable
from typing import Any

from drake_twin.ros2.launch.launch_context import LaunchContext


class Condition:
    """A condition of a launch file.

    Args:
        predicate: Called with the context; True if the action is to be executed.
    """

    def __init__(self, *, predicate: Callable[[Any], bool] | None = None):
        self._predicate = predicate

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether the condition holds now."""
        return self._predicate is not None and bool(self._predicate(context))

    def describe(self) -> str:
        """Return the condition in a few words."""
        return type(self).__name__
