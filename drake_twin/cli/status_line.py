"""The line of the terminal that shows simulation time and real-time factor."""

import sys
import time
from typing import TYPE_CHECKING

from drake_twin.program import say

if TYPE_CHECKING:
    from drake_twin.twin.twin import Twin

_PERIOD = 0.2  # s between two updates


class StatusLine:
    """Shows a running twin's time on one line; it is empty where the output is not a terminal.

    Args:
        twin: The twin.
    """

    def __init__(self, twin: "Twin"):
        self._twin = twin
        self._is_shown = sys.stdout is not None and sys.stdout.isatty()
        self._last = (time.perf_counter(), twin.time)

    def show(self) -> None:
        """Update the line, a few times a second at most."""
        now, sim_time = time.perf_counter(), self._twin.time
        then, sim_then = self._last
        if not self._is_shown or now - then < _PERIOD:
            return
        factor = max(0.0, sim_time - sim_then) / (now - then)
        state = "paused" if self._twin.clock.paused else f"real-time factor {factor:.2f}"
        say(f"\r\033[Ksim time {sim_time:.2f} s   {state}", end="")
        self._last = (now, sim_time)

    def end(self) -> None:
        """Clear the line."""
        if self._is_shown:
            say("\r\033[K", end="")
