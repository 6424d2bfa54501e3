"""The steps that a browser asks for, made in parts: a stop does not wait for all of them."""

import time as wall_clock

from drake_twin.cockpit import protocol
from drake_twin.twin.twin import Twin

_LONGEST = 0.02  # s of wall time in a frame
_AT_ONCE = 10  # steps
_ENDS = (
    *(protocol.Play, protocol.Pause, protocol.RunTo, protocol.Reset, protocol.Look, protocol.GoOnFrom),
    protocol.SetTimeStep,
)


class Stepping:
    """Makes steps of a paused twin.

    Args:
        twin: The twin.
    """

    def __init__(self, twin: Twin):
        self._twin = twin
        self._left = 0

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
        end = wall_clock.perf_counter() + _LONGEST
        while self._left and self._twin.clock.paused:
            count = min(self._left, _AT_ONCE)
            self._left -= count
            self._twin.step(count)
            if wall_clock.perf_counter() > end:
                return
        self._left = 0
