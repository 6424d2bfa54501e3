"""Waits until a lifecycle node has changed its state."""

from collections.abc import Callable
from typing import Any

from drake_twin.ros2.launch.event_handlers.on_action_event_base import OnActionEventBase
from drake_twin.ros2.launch_ros.events.lifecycle import StateTransition


class OnStateTransition(OnActionEventBase):
    """Waits until a lifecycle node has changed its state.

    The twin does not run the node, so a transition is taken to have happened when it is asked for.
    """

    waits_for = StateTransition

    def __init__(
        self,
        *,
        target_lifecycle_node: Any = None,
        entities: Any = None,
        transition: str | None = None,
        start_state: str | None = None,
        goal_state: str | None = None,
        matcher: Callable[[Any], bool] | None = None,
        **more: Any,
    ):
        super().__init__(action_matcher=target_lifecycle_node, on_event=entities, **more)
        self._transition = transition
        self._goal_state = goal_state
        self._start_state = start_state
        self._matcher = matcher

    def matches(self, event: Any) -> bool:
        """Return whether the event is of the target and its states are the ones."""
        if not super().matches(event):
            return False
        if self._matcher is not None and not self._matcher(event):
            return False
        if self._transition not in (None, event.transition, event.asked):
            return False
        return self._goal_state in (None, event.goal_state) and self._start_state in (None, event.start_state)
