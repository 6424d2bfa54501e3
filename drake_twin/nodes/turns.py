"""Threads of node programs run one at a time, each only while it has the baton.

The simulation's thread hands the baton to a thread whose time has come and waits until it comes back: in a sleep, a
spin or any other wait of the node. So nodes see and change the twin at one step boundary, in a fixed order.
"""

import logging
import sys
import threading
import time as wall_clock
from collections.abc import Callable
from math import inf
from typing import Protocol

from drake_twin.nodes.memory import resident
from drake_twin.nodes.task import Abandoned, Task, here

_MOST_ROUNDS = 1000  # rounds of turns at one simulation time, after which the threads wait for the next step
_LOOK = 0.05  # s of wall time between two looks at a thread that has the baton
_BLOCKED = 1.0  # s of wall time that it sleeps and does not work, until it is taken to wait for something outside
_BLOCKED_AGAIN = 0.1  # the same of a thread that has waited for something outside before
_GLANCE = 2e-3  # s of wall time between two looks at such a thread: it may be back in the main loop of its window
_WORK = 0.02  # the processor's time between two looks, of the wall time, below which a thread does not work
_WORTH_SAYING = 2.0  # s of the processor's time after which it is said that a thread keeps its program's others waiting
_PATIENCE = 20.0  # s of the processor's time that a thread may work in one turn
_TURNS_A_LOOK = 16  # turns of a program, of which one is measured: how much memory it takes
_FAREWELL = 0.7  # s of wall time that all threads have to end in

_new_lock = threading.Lock  # node programs have another one


class Watcher(Protocol):
    """Is told what becomes of threads."""

    def blocked(self, task: Task) -> None:
        """Take note of a thread that waits for something outside, while the simulation continues."""

    def held_up(self, task: Task) -> None:
        """Take note of a thread that computes while others of its program could continue."""

    def exceeded(self, task: Task, what: str) -> None:
        """Take note of a thread whose program takes too much, and has to end."""


class Turns:
    """Hands the baton to one thread after the other.

    Args:
        watcher: Is told what becomes of threads.
        patience: The processor's time that a thread may use in one turn (s).
        memory: How much memory a program may take (bytes).
        is_stopped: Whether the run is to end, so that no thread is waited for.

    Attributes:
        now: The simulation time (ns).
        limit: The last time (ns) that counts as now: a step may be a rounding before the time that it meets.
        after: A time (ns) between the present step and the next one.
        tasks: The threads, by the order of their programs, then of their start.
        outsider: Called before a thread goes outside, while it or the simulation's thread has the baton.
        newcomer: Called from a thread that comes back.
        is_over: Whether no thread gets another turn.
    """

    def __init__(
        self,
        watcher: Watcher,
        patience: float = _PATIENCE,
        memory: float = inf,
        is_stopped: Callable[[], bool] = lambda: False,
    ):
        self.now = self.limit = self.after = 0
        self.tasks: list[Task] = []
        self.outsider: Callable[[], None] = lambda: None
        self.newcomer: Callable[[], None] = lambda: None
        self.is_over = False
        self._watcher, self._patience, self._memory, self._is_stopped = watcher, patience, memory, is_stopped
        self._lock = _new_lock()
        self._back = _new_lock()
        self._back.acquire()
        self._running: Task | None = None

    def add(self, task: Task) -> None:
        """Add a thread, behind the others of its program."""
        place = [index for index, other in enumerate(self.tasks) if other.program.index <= task.program.index]
        self.tasks.insert(place[-1] + 1 if place else 0, task)

    def has_baton(self) -> bool:
        """Return whether the calling thread has the baton."""
        task = self._running
        return task is not None and not task.is_outside and here() is task

    def set_time(self, time: float, time_step: float) -> None:
        """Set the simulation time and the physics step (s)."""
        self.now = round(time * 1e9)
        self.limit = self.now + 1 + round(time_step * 1e3)
        self.after = self.now + max(2, round(time_step * 5e8))

    def run(self) -> float:
        """Give each thread that can continue its turns at the present time.

        Returns:
            The time (ns) at which the next thread can continue; infinite without one.
        """
        tasks = self.tasks
        for _ in range(_MOST_ROUNDS):
            have_run = set()
            for task in tuple(tasks):
                if task.can_run():
                    self.give(task)
                    have_run.add(task.program)
            # What programs send to each other arrives in a later slot: only their own threads can wake each other now.
            again = {program for program in have_run if len(program.threads) > 1}
            if not again:
                break
            tasks = [task for task in self.tasks if task.program in again]
        else:
            return self.after
        due, has_ended = inf, False
        for task in self.tasks:
            due = min(due, task.due())
            has_ended = has_ended or task.has_ended
        if has_ended:
            self.tasks = [task for task in self.tasks if not task.has_ended]
            for program in {task.program for task in self.tasks}:
                program.threads = [task for task in program.threads if not task.has_ended]
        return due

    def give(self, task: Task) -> None:
        """Hand the baton to a thread, and wait until it comes back."""
        self._running, program = task, task.program
        program.turns += 1
        before = 0 if program.turns % _TURNS_A_LOOK else resident()
        program.enter()
        try:
            task.resume()
            if not self._back.acquire(timeout=_look(task)):
                self._watch(task)
            elif before:
                program.memory += (resident() - before) * _TURNS_A_LOOK
                if program.memory > self._memory:
                    self._watcher.exceeded(task, self._too_much_memory)
        finally:
            self._running = None
            program.leave()

    @property
    def _too_much_memory(self) -> str:
        return f"it has taken more than {self._memory / (1 << 30):.3g} GiB of memory, and is ended"

    def take_back(self, task: Task) -> None:
        """Take the baton back, in the thread that had it."""
        with self._lock:
            was_outside, task.is_outside = task.is_outside, False
            if not was_outside and self._running is task:
                self._back.release()

    def let_out(self, task: Task) -> None:
        """Take the baton back, and let the thread run on."""
        self.outsider()
        with self._lock:
            task.is_outside = True
            if self._running is task:
                self._back.release()

    def let_in(self, task: Task) -> None:
        """Let a thread that is outside wait for its turn."""
        task.ready_at_once()
        with self._lock:
            task.is_outside = False
        self.newcomer()

    def farewell(self, error: type[BaseException]) -> list[Task]:
        """Raise an error in all threads, and give them a little wall time to end; return those that do not."""
        end = wall_clock.perf_counter() + _FAREWELL
        for task in self.tasks:
            task.end(error)
        while wall_clock.perf_counter() < end:
            present = [task for task in self.tasks if not task.has_ended and not task.is_outside]
            if not present:
                break
            for task in present:
                task.ready_at_once()  # its cleanup waits for nothing, as time stands still
                self._running = task
                task.program.enter()
                task.resume()
                came_back = self._back.acquire(timeout=max(0.0, end - wall_clock.perf_counter()))
                if not came_back:
                    with self._lock:
                        if not self._back.acquire(blocking=False):
                            task.is_outside = True
                self._running = None
                task.program.leave()
        self.is_over = True
        left = [task for task in self.tasks if not task.has_ended]
        for task in left:
            task.end(Abandoned, at_once=True)
        return left

    def _watch(self, task: Task) -> None:
        """Wait for a thread that works for long, or let it out if it waits for something outside, or end it."""
        look = _look(task)
        start = now = awake = wall_clock.perf_counter() - look
        first = used = task.cpu_time()
        before = resident() - task.program.memory
        is_said = not any(other.can_run() for other in task.program.threads if other is not task)
        while (waits_again := _waits_again(task)) or not self._back.acquire(timeout=look):
            last, now = now, wall_clock.perf_counter()
            before, used = used, task.cpu_time()
            if used - before >= _WORK * (now - last) or not task.is_asleep():
                awake = now
            blocked = waits_again or now - awake >= (_BLOCKED if task.blocked_at is None else _BLOCKED_AGAIN)
            worked = min(now - start, used - first)  # on a busy machine it takes longer
            if worked > _WORTH_SAYING and not is_said:
                is_said = True
                self._watcher.held_up(task)
            task.program.memory = resident() - before
            is_too_large = task.program.memory > self._memory
            exceeded = is_too_large or worked > self._patience or (self._is_stopped() and now - start > _FAREWELL / 2)
            if not blocked and not (exceeded and not _is_logging(task)):
                continue
            with self._lock:
                if self._back.acquire(blocking=False):
                    return
                task.is_outside = True
            self.outsider()
            if exceeded:
                task.end(Abandoned, at_once=True)
                what = f"it has computed for {now - start:.0f} s without a spin or a sleep, and is ended"
                if worked <= self._patience:
                    what = "it was neither in a spin nor in a sleep when the run was stopped, and is ended"
                self._watcher.exceeded(task, self._too_much_memory if is_too_large else what)
            else:
                task.blocked_at = task.place()
                self._watcher.blocked(task)
            return


def _look(task: Task) -> float:
    """Return the wall time (s) between two looks at a thread that has the baton."""
    return _LOOK if task.blocked_at is None else _GLANCE


def _waits_again(task: Task) -> bool:
    """Return whether a thread waits where it has waited for something outside before, as in the loop of a window."""
    return task.blocked_at is not None and task.is_asleep() and task.place() == task.blocked_at


def _is_logging(task: Task) -> bool:
    """Return whether a thread is inside `logging`: an error there would keep its lock from all others."""
    frame = None if task.thread is None else sys._current_frames().get(task.thread.ident or 0)
    while frame is not None and frame.f_code.co_filename != logging.__file__:
        frame = frame.f_back
    return frame is not None
