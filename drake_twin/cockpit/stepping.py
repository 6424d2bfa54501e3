"""The steps that a browser asks for, made in parts: a stop does not wait for all of them. Running to a time."""

import time as wall_clock
from collections.abc import Callable

from drake_twin.cockpit import protocol
from drake_twin.errors import InputError
from drake_twin.scenario import LONGEST_TIME
from drake_twin.twin.twin import Twin

_LONGEST = 0.02  # s of wall time in a frame
_AT_ONCE = 10  # steps
_ENDS = (
    *(protocol.Play, protocol.Pause, protocol.RunTo, protocol.Reset, protocol.Look, protocol.GoOnFrom),
    *(protocol.LookBy, protocol.Replay, protocol.SetTimeStep),
)


class Stepping:
    """Makes steps of a paused twin, and lets it run to a time.

    Args:
        twin: The twin.
    """

    def __init__(self, twin: Twin):
        self._twin = twin
        self._left = 0
        self._end_run_to: Callable[[], None] | None = None

    def run_to(self, time: float) -> None:
        """Continue, and pause at the first step that is not before a time (s).

        Raises:
            InputError: If the time lies in the past, or is too long.
        """
        twin = self._twin
        if time > LONGEST_TIME:
            raise InputError(f"{time:g} s is not a simulation time: {LONGEST_TIME:g} s is the longest")
        if time <= twin.time:
            raise InputError(f"{time:g} s lies in the past: the twin is at {twin.time:g} s. Reset it to start again")
        self.close()

        def stop(_message: object) -> None:
            if twin.time >= time - 1e-9:
                twin.pause()
                self.close()

        # A subscription with this period has its first delivery after zero at this time, exact to the step.
        self._end_run_to = twin.subscribe("/clock", stop, rate=1.0 / time)
        twin.play()

    def close(self) -> None:
        """Run to no time any more."""
        if self._end_run_to is not None:
            self._end_run_to()
            self._end_run_to = None

    def begin(self, count: int) -> None:
        """Pause the twin, and make so many more steps from the next `proceed` on."""
        self._twin.pause()
        self._left += count

    def end_before(self, request: protocol.Request) -> None:
        """Make no more steps if a request is one that moves the time otherwise, or stops it."""
        if isinstance(request, _ENDS):
            self._left = 0

    def proceed(self) -> None:
        """Make the steps that a frame has time for."""
        if not self._left:
            return
        end = wall_clock.perf_counter() + _LONGEST
        while self._left and self._twin.clock.paused:
            count = min(self._left, _AT_ONCE)
            self._left -= count
            self._twin.step(count)
            if wall_clock.perf_counter() > end:
                return
        self._left = 0
