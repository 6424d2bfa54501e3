"""What has become of an action's goal."""

from dataclasses import dataclass

from drake_twin.saved import saved

# Metadata of the parameter action_monitor_rate.
ACTION_MONITOR_RATE = {
    "lower": 0.1,
    "unsupported": "the end of a goal is reported at once",
}


@saved("GoalState")
@dataclass(frozen=True)
class GoalState:
    """The state of a goal that a controller was given.

    Attributes:
        id: the number that the controller gave it.
        status: ``accepted``, ``executing``, ``succeeded``, ``aborted`` or ``canceled``.
        error_code: of the action's result.
        error_string: of the action's result.
    """

    id: int
    status: str
    error_code: int = 0
    error_string: str = ""

    @property
    def is_done(self) -> bool:
        """Whether it has come to its end."""
        return self.status in ("succeeded", "aborted", "canceled")
