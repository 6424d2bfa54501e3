"""A goal that was sent to a controller's action."""

import logging
from collections.abc import Callable, Collection
from typing import Any

from drake_twin import messages
from drake_twin.errors import TwinError
from drake_twin.twin.owner import Owned
from drake_twin.twin.robot_control import RobotControl

_log = logging.getLogger(__name__)

_DONE = ("succeeded", "aborted", "canceled")


class ActionGoal(Owned, path="goal"):
    """A goal with its status, feedback and result.

    Args:
        action: The action's name.
        type: Its ROS type.
        id: The number that the controller assigned to the goal.
        control: The control of the robot's controllers.
        controller: The controller's name.
        on_result: Called once with this goal when it ends.

    Attributes:
        action: The action's name.
    """

    def __init__(
        self,
        action: str,
        type: str,
        id: int,
        control: RobotControl,
        controller: str,
        on_result: "Callable[[ActionGoal], None] | None",
    ):
        self._owner = control.owner
        self.action = action
        self._type = type
        self._id = id
        self._control: RobotControl | None = control
        self._name = controller
        self._on_result = on_result
        self._status = "accepted"
        self._result: Any = None

    def is_of(self, controls: Collection[RobotControl]) -> bool:
        """Return whether the goal belongs to one of these robots."""
        return self._control in controls

    @property
    def status(self) -> str:
        """``accepted``, ``executing``, ``succeeded``, ``aborted`` or ``canceled``."""
        self._look()
        return self._status

    @property
    def is_done(self) -> bool:
        """Whether the goal has ended."""
        self._look()
        return self._status in _DONE

    @property
    def result(self) -> Any:
        """The action's result message; None before the goal ends."""
        self._look()
        return self._result

    @property
    def feedback(self) -> Any:
        """The action's feedback message at the present time; None after the goal has ended."""
        if self.is_done or self._control is None:
            return None
        return self._control.controllers[self._name].feedback(self._control.context_of(self._name))

    def cancel(self) -> None:
        """Cancel the goal; the joints hold their positions."""
        if not self.is_done and self._control is not None:
            self._control.cancel(self._name)
            self._look()

    def deliver(self) -> bool:
        """Call back with the result if the goal has ended; return whether it has."""
        self._look()
        if self._status not in _DONE:
            return False
        if self._on_result is not None:
            tell, self._on_result = self._on_result, None
            try:
                tell(self)
            except TwinError as error:  # a request that the twin refuses ends only the callback
                _log.error("the callback of the goal for %s: %s", self._name, error)
        return True

    def drop(self) -> None:
        """End the goal without a callback, for example when the twin is reset."""
        self._look()
        if self._status not in _DONE:
            self._status = "canceled"
            self._on_result = None
            self._control = None  # the robot may have been deleted

    def _look(self) -> None:
        if self._status in _DONE or self._control is None:
            return
        state = self._control.controllers[self._name].goal_state(self._control.context_of(self._name))
        if state is None or state.id < self._id:
            return
        if state.id > self._id:  # another goal replaced it before its status was read
            self._end("aborted", -1, "Current goal preempted by new incoming action.")
            return
        self._status = state.status
        if state.is_done:
            self._end(state.status, state.error_code, state.error_string)

    def _end(self, status: str, code: int, text: str) -> None:
        assert self._control is not None
        self._status = status
        self._result = self._control.controllers[self._name].result(self._control.context_of(self._name))
        self._control = None
        if self._result is None:
            self._result = messages.message(f"{self._type}_Result", {"error_code": code, "error_string": text})
