"""The state of an action's goal."""

from drake_twin.dataclass import dataclass
from drake_twin.saved import saved

# Metadata of the parameter action_monitor_rate.
ACTION_MONITOR_RATE = {
    "lower": 0.1,
    "unsupported": "the end of a goal is reported at once",
}


@saved("GoalState")
@dataclass(frozen=True)
class GoalState:
    """The state of a goal of a controller's action.

    Attributes:
        id: The number that the controller assigned to it.
        status: ``accepted``, ``executing``, ``succeeded``, ``aborted`` or ``canceled``.
        error_code: The error code of the action's result.
        error_string: The error text of the action's result.
    """

    id: int
    status: str
    error_code: int = 0
    error_string: str = ""

    @property
    def is_done(self) -> bool:
        """Whether the goal has ended."""
        return self.status in ("succeeded", "aborted", "canceled")
