"""Code of other packages that computes for too long in one call: it is interrupted, as a node is that does so."""

import ctypes
import logging
import sys
import threading
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from types import FrameType, TracebackType
from typing import Self

from drake_twin.extensions import has_entry_points, is_module_of_others

_log = logging.getLogger(__name__)
PATIENCE = 20.0  # s of the processor's time in one call, as for nodes
_LOOK = 1.0  # s of wall time between two looks


class TooLongError(Exception):
    """Raised inside a call of another package's code that has taken too much of the processor's time."""

    def __init__(self, text: str = "it has computed for too long in one call, and is ended"):
        super().__init__(text)


def cpu_time(ident: int) -> float:
    """Return the processor's time that a thread has used (s); without a clock of it, as on macOS, the wall time."""
    try:
        return time.clock_gettime(time.pthread_getcpuclockid(ident))
    except (OSError, AttributeError):  # it ends, or the system has no such clock
        return time.perf_counter()


class PluginWatch:
    """Looks, once a second, which code of another package the present thread is in; a context manager.

    A call that takes too long is ended by an exception at its next line of Python. What becomes of its owner then is as
    for any exception: a controller is deactivated, a panel or a service not called again, a file not read. Code that
    catches every exception is interrupted again at each look; a call that waits, or computes outside of Python, cannot
    be ended, and is said. At the end it is said again what has been ended and what has waited, and how often.

    Args:
        patience: The processor's time that one call may take (s).
        look: The wall time between two looks (s).
    """

    def __init__(self, patience: float = PATIENCE, look: float = _LOOK):
        self._patience, self._look = patience, look
        self._ident = threading.get_ident()
        self._is_over = threading.Event()
        self._lock = threading.Lock()
        self._told: Counter[str] = Counter()
        self._thread = threading.Thread(target=self._watch, name="plug-ins' watch", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        with self._lock:  # no exception comes after this
            self._is_over.set()
        for what, count in self._told.items():
            _log.warning("%s, %d time%s", what, count, "" if count == 1 else "s")

    def _watch(self) -> None:
        call: FrameType | None = None
        since = used = 0.0
        is_said = False
        while not self._is_over.wait(self._look):
            with self._lock:
                if self._is_over.is_set():
                    return
                now, present = cpu_time(self._ident), _call_of_others(self._ident)
                if present is None or present is not call:
                    call, since, used, is_said = present, time.monotonic(), now, False
                elif now - used > self._patience:
                    self._told[f"{_place(present)} computed for too long in one call, and was interrupted"] += 1
                    ctypes.pythonapi.PyThreadState_SetAsyncExc(
                        ctypes.c_ulong(self._ident), ctypes.py_object(TooLongError)
                    )
                elif time.monotonic() - since > max(self._patience, 2 * (now - used)) and not is_said:
                    is_said = True
                    _log.warning("%s waits for something, and the simulation with it", _place(present))
                    self._told[f"{_place(present)} waited, and the simulation with it"] += 1


def plugins_watched(names: Sequence[str]) -> AbstractContextManager[object]:
    """Watch where there is something of other packages: modules that an option names, or entry points."""
    return PluginWatch() if names or has_entry_points() else nullcontext()


def _place(call: FrameType) -> str:
    return f"{call.f_code.co_filename}: {call.f_code.co_name}"


def _call_of_others(ident: int) -> FrameType | None:
    """Return the outermost call of another package's code that a thread is in; None without one."""
    frame, call, found = sys._current_frames().get(ident), None, None
    while frame is not None:
        module = str(frame.f_globals.get("__name__", ""))
        if is_module_of_others(module):
            call = frame
        elif module.startswith("drake_twin."):  # what the twin has called, and not what has called the twin
            found = call
        frame = frame.f_back
    return found
