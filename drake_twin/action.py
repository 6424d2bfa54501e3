"""A goal that was sent to a controller's action."""

from collections.abc import Callable
from typing import Any

from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.systems.controller import Controller

_DONE = ("succeeded", "aborted", "canceled")


class ActionGoal:
    """A goal on its way; ask it how it is getting on.

    Args:
        action: the action's name.
        type: its ROS type.
        id: the number that the controller gave the goal.
        controller: the controller.
        context: the controller's own context.
        on_result: called once with this goal when it is done.

    Attributes:
        action: the action's name.
    """

    def __init__(
        self,
        action: str,
        type: str,
        id: int,
        controller: Controller,
        context: Context,
        on_result: "Callable[[ActionGoal], None] | None",
    ):
        self.action = action
        self._type = type
        self._id = id
        self._controller = controller
        self._context = context
        self._on_result = on_result
        self._status = "accepted"
        self._result: Any = None

    @property
    def status(self) -> str:
        """``accepted``, ``executing``, ``succeeded``, ``aborted`` or ``canceled``."""
        self._look()
        return self._status

    @property
    def is_done(self) -> bool:
        """Whether it has come to its end."""
        return self.status in _DONE

    @property
    def result(self) -> Any:
        """The action's result message; None before the end."""
        self._look()
        return self._result

    @property
    def feedback(self) -> Any:
        """The action's feedback message at the present time; None once it is done."""
        return None if self.is_done else self._controller.feedback(self._context)

    def cancel(self) -> None:
        """Ends it; the joints hold where they are."""
        if not self.is_done:
            self._controller.cancel(self._context)
            self._look()

    def deliver(self) -> bool:
        """Tells whoever waits for the result, when it is done; returns whether it is."""
        if not self.is_done:
            return False
        if self._on_result is not None:
            tell, self._on_result = self._on_result, None
            tell(self)
        return True

    def drop(self) -> None:
        """Ends it without a word, as when the twin begins anew."""
        self._look()
        if self._status not in _DONE:
            self._status = "canceled"
            self._on_result = None

    def _look(self) -> None:
        if self._status in _DONE:
            return
        state = self._controller.goal_state(self._context)
        if state is None or state.id < self._id:
            return
        if state.id > self._id:  # another goal took its place before it was looked at
            self._end("aborted", -1, "preempted by another goal")
            return
        self._status = state.status
        if state.is_done:
            self._end(state.status, state.error_code, state.error_string)

    def _end(self, status: str, code: int, text: str) -> None:
        self._status = status
        self._result = self._controller.result(self._context)
        if self._result is None:
            self._result = messages.message(f"{self._type}_Result", {"error_code": code, "error_string": text})
