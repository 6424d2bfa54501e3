"""Python's own clocks, sleeps, locks and threads as node programs see them: with simulated time and the baton.

They are replaced for the whole process while nodes run, and behave as before for all other threads.
"""

import _thread
import builtins
import datetime as real_datetime
import queue
import random as real_random
import select
import selectors
import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from importlib.util import module_from_spec
from math import inf
from types import ModuleType
from typing import Any

from drake_twin.nodes.process_calls import REPLACEMENTS, follow_forks, seen_by_nodes
from drake_twin.nodes.standard_input import POLL, StandardInput, ask
from drake_twin.nodes.task import Task, here

_SECOND = 1_000_000_000  # ns

_SELECTORS = tuple(
    getattr(selectors, name)
    for name in ("SelectSelector", "PollSelector", "EpollSelector", "KqueueSelector")
    if hasattr(selectors, name)
)

_users = 0
_counting = threading.Lock()  # twins of several threads have nodes
_replaced: list[tuple[Any, str, Any]] = []


def install() -> None:
    """Let node programs see simulated time, until `uninstall`."""
    global _users
    with _counting:
        _users += 1
        if _users == 1:
            _replace_all()


def uninstall() -> None:
    """Let node programs see the real time again, after the last `install`."""
    global _users
    with _counting:
        _users -= 1
        if not _users:
            _restore()


def _replace_all() -> None:
    for name in ("time", "monotonic", "perf_counter"):
        _replace_for_nodes(time, name, partial(_now, 1e-9))
        _replace_for_nodes(time, f"{name}_ns", partial(_now, 1))
    _replace_for_nodes(time, "sleep", _sleep)
    _replace_for_nodes(time, "localtime", _of_now)
    _replace_for_nodes(time, "gmtime", _of_now)
    _replace_for_nodes(threading.Thread, "start", _start)
    _replace_for_nodes(threading.Thread, "join", _join)
    _replace_for_nodes(threading.Condition, "wait", _condition_wait)
    _replace_for_nodes(threading, "Lock", partial(_made, NodeLock))
    _replace_for_nodes(threading, "RLock", partial(_made, NodeRLock))
    _replace_for_nodes(queue, "SimpleQueue", partial(_made, queue._PySimpleQueue))  # type: ignore[attr-defined]
    _replace_for_nodes(select, "select", _select)
    for selector in _SELECTORS:
        _replace_for_nodes(selector, "select", _selector_select)
    for place, name, own in REPLACEMENTS:
        _replace_for_nodes(place, name, own)
    if sys.stdin is not None:
        _replace(sys, "stdin", StandardInput(sys.stdin))
    _replace_for_nodes(builtins, "input", ask)


def _restore() -> None:
    while _replaced:
        place, name, value = _replaced.pop()
        setattr(place, name, value)


follow_forks(_restore)


def own_modules(seed: int) -> dict[str, ModuleType]:
    """Return the modules of Python that each program has for itself: ``datetime``, and ``random`` with a seed."""
    spec = real_random.__spec__
    assert spec is not None
    assert spec.loader is not None
    own_random = module_from_spec(spec)
    spec.loader.exec_module(own_random)
    own_random.seed(seed)
    return {"datetime": _datetime_module(), "random": own_random}


def _replace(place: Any, name: str, value: Any) -> None:
    _replaced.append((place, name, getattr(place, name)))
    setattr(place, name, value)


def _replace_for_nodes(place: Any, name: str, own: Callable[..., Any]) -> None:
    _replace(place, name, seen_by_nodes(getattr(place, name), own))


def _now(factor: float, task: Task, real: Callable[[], Any]) -> Any:
    task.count_call()
    return task.now * factor


def _of_now(task: Task, real: Callable[..., Any], seconds: float | None = None) -> Any:
    return real(task.now / _SECOND if seconds is None else seconds)


def _sleep(task: Task, real: Callable[[float], None], seconds: float) -> None:
    if seconds < 0:
        raise ValueError("sleep length must be non-negative")
    sleep_for(task, round(seconds * _SECOND))


def sleep_for(task: Task, nanoseconds: int) -> None:
    """Let a thread wait for a span of simulation time, one step at least."""
    if task.is_outside:
        task.enter()
    task.sleep(max(task.after, task.now + nanoseconds))


def wait_until(task: Task, is_ready: Callable[[], bool], timeout: float | None) -> bool:
    """Let a thread wait for a condition, at most for some simulation time (s); return whether it holds."""
    if task.is_outside:
        task.enter()
    if is_ready():
        return True
    if timeout == 0:
        task.count_idle_call()
        return is_ready()
    until = inf
    if timeout is not None and timeout > 0:
        until = max(task.after, task.now + round(min(timeout, 1e9) * _SECOND))
    task.wait(is_ready, until)
    return is_ready()


# Threads and locks ---------------------------------------------------------------------------------------------------


def _start(task: Task, real: Callable[..., None], thread: threading.Thread) -> None:
    run = thread.run
    task.new_thread(lambda: task.program.guard(run), thread)


def _join(task: Task, real: Callable[..., None], thread: threading.Thread, timeout: float | None = None) -> None:
    other = next((item for item in task.program.threads if item.thread is thread), None)
    if other is None or other is task:
        real(thread, timeout)
    elif wait_until(task, lambda: other.has_ended, timeout):
        real(thread)  # what is left of it is Python's own, and takes no turn


def _condition_wait(task: Task, real: Callable[..., bool], condition: Any, timeout: float | None = None) -> bool:
    if not condition._is_owned():
        raise RuntimeError("cannot wait on un-acquired lock")
    waiter = _thread.allocate_lock()
    waiter.acquire()
    condition._waiters.append(waiter)
    saved = condition._release_save()
    notified = False
    try:
        notified = wait_until(task, lambda: not waiter.locked(), timeout)
    finally:
        condition._acquire_restore(saved)
        if not notified and waiter in condition._waiters:
            condition._waiters.remove(waiter)
    return notified


class NodeLock:
    """A lock for which a node's thread waits without the baton."""

    def __init__(self) -> None:
        self._lock = _thread.allocate_lock()

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        task = here()
        if task is None:
            return self._lock.acquire(blocking, timeout)
        if self._lock.acquire(False):
            return True
        if not blocking:
            return False
        wait = None if timeout < 0 else timeout
        return wait_until(task, lambda: not self._lock.locked(), wait) and self.acquire(blocking=False)

    def release(self) -> None:
        self._lock.release()

    def locked(self) -> bool:
        return self._lock.locked()

    def _at_fork_reinit(self) -> None:
        self._lock = _thread.allocate_lock()

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *error: object) -> None:
        self.release()


class NodeRLock(threading._PyRLock):  # type: ignore[name-defined]
    """A lock that its owner can acquire again, for which a node's thread waits without the baton."""

    def __init__(self) -> None:
        super().__init__()
        self._block = NodeLock()


def _made(own: Callable[..., Any], task: Task, real: Callable[..., Any], *arguments: Any) -> Any:
    return own(*arguments)


# Files ---------------------------------------------------------------------------------------------------


def _select(
    task: Task, real: Callable[..., Any], reading: Any, writing: Any, failing: Any, timeout: float | None = None
) -> Any:
    if timeout is None:
        with task.outside():
            return real(reading, writing, failing)
    end = task.now + round(timeout * _SECOND)
    while True:
        found = real(reading, writing, failing, 0)
        if any(found) or (timeout > 0 and task.now >= end):
            return found
        sleep_for(task, min(POLL, end - task.now))
        if timeout == 0:
            return real(reading, writing, failing, 0)


def _selector_select(task: Task, real: Callable[..., Any], selector: Any, timeout: float | None = None) -> Any:
    """Let ``asyncio`` and others that wait for files or a time wait in simulated time."""
    if timeout is not None and timeout <= 0:
        task.count_call()
        return real(selector, timeout)
    found: list[Any] = []

    def is_ready() -> bool:
        found[:] = found or real(selector, 0)
        return bool(found)

    end = inf if timeout is None else task.now + round(timeout * _SECOND)
    while not is_ready() and task.now < end:
        task.watch(is_ready, round(min(POLL, end - task.now)))
    return found


# Dates ---------------------------------------------------------------------------------------------------------------


_IMPORTERS = ("importlib._bootstrap", "importlib._bootstrap_external")  # whose frames call a compiled module's code


class _OfReal(type):
    def __instancecheck__(cls, value: object) -> bool:
        return isinstance(value, real_datetime.datetime)

    def __subclasscheck__(cls, other: type) -> bool:
        return issubclass(other, real_datetime.datetime)


class _DateTime(real_datetime.datetime, metaclass=_OfReal):
    """A date and time whose present is the simulation's."""

    __slots__ = ()

    @classmethod
    def now(cls, tz: Any = None) -> Any:
        return cls.fromtimestamp(time.time(), tz)

    @classmethod
    def utcnow(cls) -> Any:
        return cls.fromtimestamp(time.time(), real_datetime.UTC).replace(tzinfo=None)

    @classmethod
    def today(cls) -> Any:
        return cls.now()

    def __repr__(self) -> str:
        return f"datetime.{super().__repr__()}" if type(self) is _DateTime else super().__repr__()


_DateTime.__name__ = _DateTime.__qualname__ = _DateTime.__module__ = "datetime"  # as programs and pickles name it


def _datetime_module() -> ModuleType:
    module = ModuleType("datetime", real_datetime.__doc__)
    module.__dict__.update(vars(real_datetime))
    del module.__dict__["datetime"]
    module.__dict__["__getattr__"] = _date_time_class
    return module


def _date_time_class(name: str) -> type:
    """Return the class ``datetime``: compiled modules that are being imported, such as those of pandas, need Python's.

    They derive types from it and rely on its size in memory.
    """
    if name != "datetime":
        raise AttributeError(f"module 'datetime' has no attribute {name!r}", name=name)
    is_compiled = sys._getframe(1).f_globals.get("__name__") in _IMPORTERS
    return real_datetime.datetime if is_compiled else _DateTime
