"""What the services of all simulators share: time, and requests that are refused without a field for the reason."""

import logging
import time as wall_clock
from collections.abc import Callable, Generator
from typing import Any

from drake_twin.errors import InputError, TwinError
from drake_twin.services.registry import Fields
from drake_twin.twin.twin import Twin

# simulation_interfaces/msg/Result
UNSUPPORTED, OK, NOT_FOUND, INCORRECT_STATE, FAILED = range(5)

_log = logging.getLogger(__name__)
_MOST_STEPS = 1_000_000_000
_SLICE = 0.02  # s of wall time that steps may take before other requests get their turn
_MOST_LINES = 1000
_logged: set[tuple[str, str]] = set()


def play(twin: Twin) -> None:
    """Let time continue.

    Raises:
        InputError: If the twin runs in lock-step.
    """
    if twin.frames.lockstep:
        raise InputError("the twin runs in lock-step: it advances only when StepSimulation or SimulateSteps says so")
    twin.play()


def reset(twin: Twin) -> None:
    """Return to the start, which lets ``/clock`` jump back."""
    _log.warning("reset: /clock jumps back from %.3f s to zero", twin.time)
    twin.reset()


def steps(twin: Twin, number: int) -> Generator[int, None, None]:
    """Make physics steps, a slice at a time; each slice yields the number of steps made so far.

    Raises:
        InputError: If the twin is not paused, or the number is not one of steps.
        RunError: If a step fails.
    """
    if not 1 <= number <= _MOST_STEPS:
        raise InputError(f"{number} steps cannot be made: the number must be from 1 to {_MOST_STEPS}")
    made = 0
    while made < number:
        if not twin.clock.paused:
            raise InputError("time is running: pause the simulation before it is stepped")
        begin = wall_clock.perf_counter()
        while made < number and wall_clock.perf_counter() - begin < _SLICE:
            twin.step()
            made += 1
        yield made


class StepsGoal:
    """Physics steps as the goal of an action; `proceed` makes a slice of them.

    Args:
        twin: The twin, which must be paused.
        number: The number of steps.

    Raises:
        InputError: If the twin is not paused, or the number is not one of steps.
    """

    def __init__(self, twin: Twin, number: int):
        self._number = number
        self._made = 0
        self._slices = steps(twin, number)
        self._is_stepping = False
        self.status = "executing"
        self.result: Fields | None = None
        self.proceed()

    @property
    def is_done(self) -> bool:
        """Whether the goal has ended."""
        return self.result is not None

    @property
    def feedback(self) -> Fields | None:
        """The number of steps made and left; None after the goal has ended."""
        return None if self.is_done else {"completed_steps": self._made, "remaining_steps": self._number - self._made}

    def cancel(self) -> None:
        """Make no more steps."""
        self._end("canceled", FAILED, f"canceled after {self._made} steps")

    def proceed(self) -> None:
        """Make the next slice of steps."""
        if self.is_done or self._is_stepping:
            return
        self._is_stepping = True
        try:
            self._made = next(self._slices)
        except TwinError as error:
            if not self._made:
                raise
            self._end("aborted", FAILED, str(error))
        else:
            if self._made == self._number:
                self._end("succeeded", OK, "")
        finally:
            self._is_stepping = False

    def _end(self, status: str, code: int, text: str) -> None:
        self.status, self.result = status, {"result": {"result": code, "error_message": text}}


def tried(service: str, do: Callable[[], object], field: str = "success") -> Fields:
    """Return the response to a request that a function does: whether it succeeds is all that the response tells."""
    try:
        do()
    except TwinError as error:
        return refused(service, error, field)
    return {field: True} if field else {}


def refused(service: str, error: Any, field: str = "") -> Fields:
    """Log why a request is refused, once per service and reason; return the response, which has no field for it."""
    key = service, str(error)
    if key not in _logged and len(_logged) < _MOST_LINES:
        _logged.add(key)
        _log.warning("%s: %s", *key)
    return {field: False} if field else {}
