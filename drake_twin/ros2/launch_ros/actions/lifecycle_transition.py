"""Asks lifecycle nodes for transitions."""

from collections.abc import Iterable
from functools import partial
from typing import Any

from drake_twin.errors import InputError
from drake_twin.ros2.event_effects import emit
from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch_ros.events.lifecycle import ChangeState
from drake_twin.ros2.launch_ros.events.matchers import matches_node_name


class LifecycleTransition(Action):
    """Asks lifecycle nodes for transitions, one after the other.

    Args:
        lifecycle_node_names: The full names of the nodes.
        transition_ids: The numbers of ``lifecycle_msgs/msg/Transition``.

    Raises:
        ValueError: If there are no nodes or no transitions.
    """

    def __init__(self, *, lifecycle_node_names: Iterable[Any], transition_ids: Iterable[Any], **kwargs: Any):
        super().__init__(**kwargs)
        self._names, self._transitions = list(lifecycle_node_names), list(transition_ids)
        for what, given in (("transition_ids", self._transitions), ("lifecycle_node_names", self._names)):
            if not given:
                raise ValueError(f"No {what} provided.")

    def execute(self, context: LaunchContext) -> None:
        """Ask for the transitions.

        Raises:
            InputError: If a transition is not a number.
        """
        for given in self._transitions:
            number = given if isinstance(given, int) else context.perform_substitution(given)
            try:
                transition = int(number)
            except ValueError:
                raise InputError(f"the lifecycle transition {number!r} is not a number", value=str(number)) from None
            for name in self._names:
                ask_for_transition(context, context.perform_substitution(name), transition)


def ask_for_transition(context: LaunchContext, name: str, transition: int) -> None:
    """Ask a lifecycle node for a transition, after the events that are due before it."""
    event = ChangeState(lifecycle_node_matcher=matches_node_name(name), transition_id=transition)
    context.events.after(0.0, partial(emit, context, event))
