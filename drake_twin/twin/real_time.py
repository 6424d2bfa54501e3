"""The run loop: wall time grants simulation time, frame by frame."""

import time as wall_clock
from collections import deque
from collections.abc import Callable
from dataclasses import field
from math import floor, inf
from typing import Protocol

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.twin.inbox import Inbox
from drake_twin.twin.schedule import step_at
from drake_twin.twin.twin_clock import TwinClock

_FRAME = 1 / 30  # s of wall time between two frames
_SLICES = 7  # of a frame while other programs use the inbox: none longer than 5 ms
_MOST_STEPS_A_FRAME = 10_000
_LONGEST = 2 * _FRAME  # s of wall time that a frame's steps may take: a slow twin has shorter frames, not fewer
_SHARE = 3  # of a frame's steps to all else in it, at least, whatever they take
_LAST = 3  # frames whose fastest tells what a step takes
_MOST_BEHIND = 0.25  # s of wall time that is caught up after the processor was busy elsewhere, as with a browser
_SLICE = 0.01  # s of simulation time between two looks at the wall clock in a run that never waits


@dataclass
class Frames:
    """The frames of `Twin.run`.

    Attributes:
        callbacks: Functions that `Twin.run` calls each frame, before ``each_frame``, and once more when it ends. They
            are called between steps, so that they may do anything but advance the twin.
        are_running: Whether `Twin.run` is executing.
        lockstep: Whether time advances only by requests of steps: `Twin.run` pauses the twin at each frame.
        missed: The simulation time that the wall clock had granted and that was not simulated, as the processor was too
            slow (s).
        missed_at: The simulation time at which that was so last (s).
    """

    callbacks: list[Callable[[], object]] = field(default_factory=list)
    are_running: bool = False
    lockstep: bool = False
    missed: float = 0.0
    missed_at: float = -inf

    def miss(self, span: float, at: float) -> None:
        """Take note of simulation time that was granted and is not simulated (s), at a simulation time (s)."""
        if span > 0.0:
            self.missed, self.missed_at = self.missed + span, at


class Running(Protocol):
    """What is run, which is `Twin`; its members are described there."""

    inbox: Inbox
    frames: Frames
    clock: TwinClock

    @property
    def time(self) -> float:
        """The simulation time (s)."""

    def pause(self) -> None:
        """Let time stand still."""

    def draw(self) -> None:
        """Draw the present."""

    def advance_to(self, time: float) -> float:
        """Advance to a time (s)."""


def run_in_real_time(
    twin: Running, until: float | None, each_frame: Callable[[], bool | None], *, as_fast_as_possible: bool
) -> None:
    """Run a twin frame by frame; `Twin.run` documents the arguments."""
    twin.frames.are_running = True
    try:
        _run(twin, until, each_frame, as_fast_as_possible=as_fast_as_possible)
    finally:
        twin.frames.are_running = False


def _run(
    twin: Running, until: float | None, each_frame: Callable[[], bool | None], *, as_fast_as_possible: bool
) -> None:
    frame_start = wall_clock.perf_counter()
    owed = 0.0  # simulation time that the wall clock has granted and no step has used yet (s)
    costs = deque[float](maxlen=_LAST)  # s of wall time of a step
    while True:
        begin = wall_clock.perf_counter()
        if not _begin_frame(twin, until, each_frame):
            break
        twin.draw()
        longest = max(_LONGEST, _SHARE * (wall_clock.perf_counter() - begin))
        if as_fast_as_possible and not twin.clock.paused:
            _advance_for(twin, _FRAME, until)
            continue
        slices = _SLICES if twin.inbox.is_urgent else 1
        for _ in range(slices):
            if not twin.clock.paused:
                owed += _FRAME / slices * twin.clock.real_time_rate
                most = longest / slices / max(min(costs, default=0.0), 1e-9)
                steps = min(floor(owed / twin.clock.time_step + 1e-9), max(1, int(most)), _MOST_STEPS_A_FRAME)
                left = owed - steps * twin.clock.time_step
                owed = min(left, twin.clock.time_step)
                twin.frames.miss(left - owed, twin.time)
                start = wall_clock.perf_counter()
                _advance_by(twin, steps, until)
                if steps:
                    costs.append((wall_clock.perf_counter() - start) / steps)
            if twin.inbox.is_open:
                twin.inbox.work()
            due, latest = frame_start + _FRAME / slices, wall_clock.perf_counter() - _MOST_BEHIND
            if latest > due and not twin.clock.paused:
                twin.frames.miss((latest - due) * twin.clock.real_time_rate, twin.time)
            frame_start = max(due, latest)
            _wait_until(twin, frame_start)
    twin.draw()


def _wait_until(twin: Running, wall_time: float) -> None:
    """Wait; a twin that is paused does requests as they arrive, so that stepping it from outside takes no frame."""
    while (left := wall_time - wall_clock.perf_counter()) > 0:
        if twin.clock.paused and twin.inbox.is_open:
            twin.inbox.wait(left)
            twin.inbox.work()
        else:
            wall_clock.sleep(left)


def _begin_frame(twin: Running, until: float | None, each_frame: Callable[[], bool | None]) -> bool:
    """Call what each frame calls; return whether the run continues."""
    if twin.frames.lockstep:
        twin.pause()
    for callback in tuple(twin.frames.callbacks):
        callback()
    if _is_over(twin, until):
        return False
    answer = each_frame()
    return not isinstance(answer, bool | np.bool_) or bool(answer)


def _is_over(twin: Running, until: float | None) -> bool:
    return until is not None and twin.clock.step_count >= step_at(until, twin.clock.time_step)


def _advance_by(twin: Running, steps: int, until: float | None) -> None:
    """Advance by a number of steps, but not past the end."""
    target = twin.clock.step_count + steps
    if until is not None:
        target = min(target, step_at(until, twin.clock.time_step))
    if target > twin.clock.step_count:
        twin.advance_to(target * twin.clock.time_step)


def _advance_for(twin: Running, wall_time: float, until: float | None) -> None:
    """Advance for about a span of wall time (s)."""
    start = wall_clock.perf_counter()
    while not twin.clock.paused and not _is_over(twin, until):
        _advance_by(twin, max(1, round(_SLICE / twin.clock.time_step)), until)
        if wall_clock.perf_counter() - start > wall_time:
            return
