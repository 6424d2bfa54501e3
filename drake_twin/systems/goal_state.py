"""How an action's goal is getting on."""

from dataclasses import dataclass


@dataclass(frozen=True)
class GoalState:
    """The state of an action's present or last goal.

    Attributes:
        id: the goal's number, counted by its controller from 1.
        status: ``accepted``, ``executing``, ``succeeded``, ``aborted`` or ``canceled``.
        error_code: the result's error code, for actions that have one.
        error_string: the result's error text, for actions that have one.
    """

    id: int
    status: str
    error_code: int = 0
    error_string: str = ""

    @property
    def is_done(self) -> bool:
        """Whether the goal has come to its end."""
        return self.status in ("succeeded", "aborted", "canceled")
