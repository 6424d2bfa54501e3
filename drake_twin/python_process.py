"""What the Python processes that the twin starts have in common: where they search modules, and how they end.

``python -m`` searches the working folder first, which may be a stranger's: with a ``json.py`` in it, say. The program
``drake-twin`` does not, so neither must what it starts.

Ctrl-C, a closed terminal and the stop of a service reach these processes, too. They are for the twin alone, which ends
the others once it has written what they hold; so they are held back from the first moment of such a process on.
"""

import contextlib
import os
import signal
import sys
from collections.abc import Iterator

_VARIABLE, _OURS = "PYTHONSAFEPATH", "drake_twin"
STOPS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG of Linux's prctl


def own_cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def python_command(module: str) -> tuple[str, ...]:
    """Return the command that runs a module as a program."""
    return (sys.executable, *(() if _searches_working_folder() else ("-P",)), "-m", module)


@contextlib.contextmanager
def same_module_search() -> Iterator[None]:
    """Let a process of `multiprocessing` that is started here search as this one does, from its first import on.

    It calls `end_module_search`, so that programs which it starts are not affected.
    """
    if _searches_working_folder() or _VARIABLE in os.environ:
        yield
        return
    os.environ[_VARIABLE] = _OURS
    try:
        yield
    finally:
        os.environ.pop(_VARIABLE, None)


def end_module_search() -> None:
    """Remove what `same_module_search` has set in the environment of this process."""
    if os.environ.get(_VARIABLE) == _OURS:
        del os.environ[_VARIABLE]


@contextlib.contextmanager
def stops_held_back() -> Iterator[None]:
    """Let a process that is started here get no signal that stops a program until it calls `ignore_stops`."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, STOPS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def ignore_stops() -> None:
    """Ignore the signals that stop a program, in a process that the twin ends."""
    for number in STOPS:
        signal.signal(number, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, STOPS)


def die_with(parent: int) -> None:
    """Let the system end this process with its parent, also where that is killed.

    Args:
        parent: The parent's number.
    """
    import ctypes  # 5 ms, which only such a process needs

    with contextlib.suppress(OSError, AttributeError):  # another system than Linux
        ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)
    if os.getppid() != parent:  # it has ended before
        os._exit(1)


def _searches_working_folder() -> bool:
    with contextlib.suppress(OSError):  # the folder has been removed
        return "" in sys.path or os.getcwd() in sys.path
    return False
