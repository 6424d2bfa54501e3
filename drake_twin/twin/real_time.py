"""The run loop: wall time grants simulation time, frame by frame."""

import time as wall_clock
from collections.abc import Callable
from math import floor
from typing import TYPE_CHECKING

from drake_twin.twin.schedule import step_at

if TYPE_CHECKING:
    from drake_twin.twin.twin import Twin

_FRAME = 1 / 30  # period of the page's and the wall clock's turns (s)
_MOST_STEPS_A_FRAME = 10_000
_MOST_BEHIND = (
    0.25  # largest wall time (s) to catch up after a pause of the process, for example while a browser renders
)
_SLICE = 0.01  # simulated s between two readings of the wall clock in a run that never waits


def run_in_real_time(
    twin: "Twin", until: float | None, each_frame: Callable[[], bool], *, as_fast_as_possible: bool
) -> None:
    """Run a twin; see `Twin.run` for the arguments."""
    frame_start = wall_clock.perf_counter()
    owed = 0.0  # simulation time granted by the wall clock and not yet used by a step (s)
    while not _is_over(twin, until) and each_frame():
        twin.draw()
        if as_fast_as_possible and not twin.paused:
            _advance_for(twin, _FRAME, until)
            continue
        if not twin.paused:
            owed += _FRAME * twin.real_time_rate
            steps = min(floor(owed / twin.time_step + 1e-9), _MOST_STEPS_A_FRAME)
            owed = min(owed - steps * twin.time_step, twin.time_step)
            _advance_by(twin, steps, until)
        frame_start = max(frame_start + _FRAME, wall_clock.perf_counter() - _MOST_BEHIND)
        wall_clock.sleep(max(0.0, frame_start - wall_clock.perf_counter()))
    twin.draw()


def _is_over(twin: "Twin", until: float | None) -> bool:
    return until is not None and twin.step_count >= step_at(until, twin.time_step)


def _advance_by(twin: "Twin", steps: int, until: float | None) -> None:
    """Advance by some steps, but not beyond the end."""
    target = twin.step_count + steps
    if until is not None:
        target = min(target, step_at(until, twin.time_step))
    if target > twin.step_count:
        twin.advance_to(target * twin.time_step)


def _advance_for(twin: "Twin", wall_time: float, until: float | None) -> None:
    """Advance for about this wall time (s)."""
    start = wall_clock.perf_counter()
    while not twin.paused and not _is_over(twin, until):
        _advance_by(twin, max(1, round(_SLICE / twin.time_step)), until)
        if wall_clock.perf_counter() - start > wall_time:
            return
