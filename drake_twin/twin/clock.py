"""A twin's time, counted in physics steps."""

from collections.abc import Mapping
from typing import Any

from drake_twin.errors import InputError
from drake_twin.scenario import LONGEST_TIME
from drake_twin.twin.schedule import meeting_step, step_at
from drake_twin.values import is_number


class Clock:
    """The present step, the length of a step, and the length to change to.

    Args:
        time_step: The physics step (s).

    Attributes:
        step: The number of physics steps since time zero, counted in steps of the present length; `go_to` sets it.
        time: Simulation time (s), written at once, so that other threads may read it.
        time_step: The physics step (s).
        next_time_step: The step to change to at its next multiple (s); None for no change.
    """

    def __init__(self, time_step: float):
        self.time_step = time_step
        self.step, self.time = 0, 0.0
        self.next_time_step: float | None = None

    def go_to(self, step: int) -> None:
        """Set the present step."""
        self.step, self.time = step, step * self.time_step

    def use(self, time_step: float) -> None:
        """Count in steps of this length (s) from now on."""
        step = step_at(self.time, time_step)
        self.time_step = time_step
        self.go_to(step)

    def steps(self, period: float) -> int:
        """Return the number of steps of a period (s), one at least."""
        return max(1, round(period / self.time_step))

    def step_at(self, time: Any) -> int:
        """Return the first step that is not before a time (s).

        Raises:
            InputError: If the time is not a finite number, or is too large.
        """
        if not is_number(time, -LONGEST_TIME) or time > LONGEST_TIME:
            raise InputError(f"{time!r} is not a simulation time")
        return step_at(time, self.time_step)

    def change_step(self) -> int | None:
        """Return the step at which the step length changes; None for no change."""
        if self.next_time_step is None:
            return None
        return meeting_step(self.step, self.time_step, self.next_time_step)

    def state(self) -> dict[str, Any]:
        """Return the entries of a snapshot that this part keeps."""
        return {"time_step": self.time_step, "step": self.step, "next_time_step": self.next_time_step}

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set the entries that `state` returned; the scenario sets the step length."""
        self.go_to(state["step"])
        self.next_time_step = state["next_time_step"]
        if self.next_time_step is not None:
            meeting_step(self.step, self.time_step, self.next_time_step)
