"""A thread of a node program, which runs only while it has the baton."""

import contextlib
import ctypes
import sys
import threading
from collections.abc import Callable, Iterator
from math import inf
from typing import Any, Protocol

from drake_twin.plugin_watch import cpu_time

_MOST_CALLS = 1000  # calls at one simulation time, after which a thread waits for the next step
_MOST_WAITS = 100  # waits of a program after its own handler of Ctrl-C, until it is interrupted nevertheless
_MOST_IDLE_CALLS = 10  # calls at one simulation time that find nothing to do

# These work for the wait of a node, and for the node that starts a thread.
_start_thread = threading.Thread.start
_new_lock = threading.Lock


class Abandoned(BaseException):
    """Raised in a thread that has to end at once; nodes that catch `Exception` do not catch it."""


class Baton(Protocol):
    """What a thread knows of `drake_twin.nodes.turns.Turns`, which hands out the baton.

    Attributes:
        now: The simulation time (ns).
        limit: The last time (ns) that counts as now.
        after: A time (ns) between the present step and the next one.
    """

    now: int
    limit: int
    after: int

    def take_back(self, task: "Task") -> None:
        """Take the baton back, in the thread that had it."""

    def let_out(self, task: "Task") -> None:
        """Take the baton back, and let the thread run on."""

    def let_in(self, task: "Task") -> None:
        """Take note of a thread that comes back and waits for its turn."""


class Task:
    """A thread of a node program.

    Args:
        turns: Hands out the baton.
        program: The `drake_twin.nodes.program.Program` that it belongs to.

    Attributes:
        program: The program that it belongs to.
        thread: The thread.
        is_outside: Whether it runs without the baton, as it waits for something outside.
        has_ended: Whether it has ended.
        is_daemon: Whether it ends when all others of its program have ended.
        blocked_at: Where it has waited for something outside with the baton, see `place`; None before.
        is_watching: Whether it waits for something that can come while the twin is paused.
    """

    def __init__(self, turns: Baton, program: Any):
        self.program = program
        self.thread: threading.Thread | None = None
        self.is_outside = False
        self.has_ended = False
        self.is_daemon = False
        self.blocked_at: tuple[int, int] | None = None
        self.is_watching = False
        self._turns = turns
        self._go = _new_lock()
        self._go.acquire()
        self._is_ready: Callable[[], bool] = _always
        self._until: float = -1
        self._due: Callable[[], float] = _never
        self._calls = self._idle_calls = 0
        self._time = -1
        self._is_interrupted = False
        self._waits_left = 0
        self._end: type[BaseException] | None = None

    def start(self, run: Callable[[], None], thread: threading.Thread | None = None) -> None:
        """Start the thread; it runs when its turn comes.

        Args:
            run: What it does.
            thread: A thread of the user's, not started yet; a new one by default.
        """

        def begin() -> None:
            _TASKS[threading.get_ident()] = self
            # Python does not wait for it at the process's end; what it starts is to be as it is to the program.
            threading.current_thread()._daemonic = self.is_daemon  # type: ignore[attr-defined]
            self._go.acquire()
            try:
                if self._end is None:
                    run()
            except (Abandoned, KeyboardInterrupt):
                pass
            finally:
                self.has_ended = True
                _TASKS.pop(threading.get_ident(), None)
                self._turns.take_back(self)

        if thread is None:
            thread = threading.Thread(name=self.program.what)
        else:
            self.is_daemon = thread.daemon
        thread.run, thread.daemon = begin, True  # type: ignore[method-assign]
        self.thread = thread
        starter = _TASKS.pop(threading.get_ident(), None)  # the start waits for the thread to begin, with the baton
        try:
            _start_thread(thread)
        finally:
            if starter is not None:
                _TASKS[threading.get_ident()] = starter

    @property
    def now(self) -> int:
        """The simulation time (ns)."""
        return self._turns.now

    @property
    def limit(self) -> int:
        """The last time (ns) that counts as now."""
        return self._turns.limit

    @property
    def after(self) -> int:
        """A time (ns) between the present step and the next one."""
        return self._turns.after

    def new_thread(self, run: Callable[[], None], thread: threading.Thread | None = None) -> "Task":
        """Start another thread of its program; see `start`."""
        task = Task(self._turns, self.program)
        task.is_daemon = thread is None
        self.program.add(task)
        task.start(run, thread)
        return task

    def can_run(self) -> bool:
        """Return whether its wait is over."""
        if self.is_outside or self.has_ended:
            return False
        limit = self._turns.limit
        return self._until <= limit or self._due() <= limit or self._is_ready()

    def due(self) -> float:
        """Return the time (ns) at which its wait ends; infinite without one."""
        return inf if self.is_outside or self.has_ended else min(self._until, self._due())

    def shift(self, by: int) -> None:
        """Move the end of its wait after time has jumped by ns."""
        self._until += by

    def wait(self, is_ready: Callable[[], bool], until: float = inf, due: Callable[[], float] | None = None) -> None:
        """Give the baton back, in its own thread.

        Args:
            is_ready: Returns whether the wait is over.
            until: The time (ns) at which it is over anyway; a jump of time moves it.
            due: Returns a time (ns) at which it is over, which may change.
        """
        if self.is_outside:
            self.enter()
        self._is_ready, self._until, self._due = is_ready, until, due or _never
        self._turns.take_back(self)
        self._go.acquire()
        if self._end is not None:
            self._raise_end()

    def watch(self, is_ready: Callable[[], bool], period: int) -> None:
        """Wait for something outside for some ns at most, and for less while the twin is paused."""
        self.is_watching = True
        try:
            self.wait(is_ready, self._turns.now + max(period, self._turns.after - self._turns.now))
        finally:
            self.is_watching = False

    def sleep(self, until: float) -> None:
        """Wait until a time (ns)."""
        self.wait(_not_yet, until)

    def count_idle_call(self) -> None:
        """Count a call that found nothing to do: some at one time, and the thread waits for the next step."""
        self._idle_calls += 1
        if self._idle_calls > _MOST_IDLE_CALLS:
            self._idle_calls = 0
            self.sleep(self._turns.after)

    def count_call(self) -> None:
        """Count a call; a thread that calls on and on without a wait waits for the next step now and then."""
        if self.is_outside:
            self.enter()
        now = self._turns.now
        if now != self._time:
            self._calls = self._idle_calls = 0
            self._time = now
        self._calls += 1
        if self._calls > _MOST_CALLS:
            self._calls = 0
            self.sleep(self._turns.after)

    @contextlib.contextmanager
    def outside(self) -> Iterator[None]:
        """Let the simulation continue while the thread waits for something outside."""
        if self.is_outside:
            yield
            return
        self._turns.let_out(self)
        try:
            yield
        finally:
            self.enter()

    def enter(self) -> None:
        """Wait for a turn, after having been outside."""
        self._turns.let_in(self)
        self._go.acquire()
        self._raise_end()

    def resume(self) -> None:
        """Let it run, in the simulation's thread."""
        self._is_ready, self._until, self._due = _not_yet, inf, _never
        self._go.release()

    def ready_at_once(self) -> None:
        """Let its wait be over."""
        self._is_ready = _always

    def end(self, error: type[BaseException], *, at_once: bool = False) -> None:
        """Raise an error in the thread, at the end of its present wait, or wherever it is."""
        self._end = error
        self.ready_at_once()
        if at_once and self.thread is not None and self.thread.ident is not None:
            ident = ctypes.c_ulong(self.thread.ident)
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ident, ctypes.py_object(error))

    def cpu_time(self) -> float:
        """Return the processor's time that the thread has used (s); without a clock of it, the wall time."""
        assert self.thread is not None
        assert self.thread.ident is not None
        return cpu_time(self.thread.ident)

    def is_asleep(self) -> bool:
        """Return whether the thread waits for something; not for the processor or a disk, where the system says so."""
        assert self.thread is not None
        try:
            with open(f"/proc/self/task/{self.thread.native_id}/stat", encoding="utf-8") as file:
                return file.read().rpartition(")")[2].split()[0] == "S"
        except (OSError, IndexError):
            return True

    def place(self) -> tuple[int, int]:
        """Return the Python call and the instruction in it at which the thread is."""
        assert self.thread is not None
        frame = sys._current_frames().get(self.thread.ident or 0)
        return (0, 0) if frame is None else (id(frame), frame.f_lasti)

    def _raise_end(self) -> None:
        """Raise what it has to end with; a program's own handler of Ctrl-C has some waits of time to end otherwise."""
        error = self._end
        if error is None:
            return
        if error is KeyboardInterrupt and not self._is_interrupted and self is self.program.main:
            self._is_interrupted = True
            self._waits_left = _MOST_WAITS if self.program.handle_interrupt() else 0
        if error is KeyboardInterrupt and self._waits_left:
            self._waits_left -= 1
            return
        self._end = None
        raise error


_TASKS: dict[int, Task] = {}  # by the identifiers of their threads


def here() -> Task | None:
    """Return the task of the present thread; None if it is not one of a node program."""
    return _TASKS.get(threading.get_ident())


def present_task() -> Task:
    """Return the task of the present thread, with the baton.

    Raises:
        RuntimeError: If it is not a thread of a node program.
    """
    task = here()
    if task is None:
        raise RuntimeError("rclpy can be used only in the threads of a node that a twin runs")
    task.count_call()
    return task


def forget_tasks() -> None:
    """Let no thread be one of a node program."""
    _TASKS.clear()


def _always() -> bool:
    return True


def _not_yet() -> bool:
    return False


def _never() -> Any:
    return inf
