"""The engine of one machine: processes that each keep one built twin and get their episodes through a pipe."""

import contextlib
import ctypes
import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Collection
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess

from drake_twin.sweeps.dispatch import Dispatcher, Worker, WorkerEndedError
from drake_twin.sweeps.episode import Row, Runner, Sweep
from drake_twin.sweeps.variation import Episode

_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG of Linux's prctl


def workers_of_machine() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class _Process(Worker):
    """A process at the other end of a pipe."""

    def __init__(self, sweep: Sweep, process: SpawnProcess, connection: Connection):
        super().__init__()
        self._sweep, self._process, self.connection = sweep, process, connection

    @property
    def process(self) -> int | None:
        return self._process.pid

    def send(self, episode: Episode) -> None:
        with contextlib.suppress(OSError):  # it has died meanwhile, which its connection tells
            self.connection.send(episode)

    def receive(self) -> Row | None:
        try:
            row: Row | None = self.connection.recv()
        except (EOFError, OSError):
            self._process.join()
            raise WorkerEndedError(f"its process ended{_why(self._process.exitcode)}") from None
        if row is None:
            with contextlib.suppress(OSError):
                self.connection.send(self._sweep)
        return row

    def end(self) -> None:
        self.connection.close()
        self._process.kill()
        self._process.join()


class Engine(Dispatcher[_Process]):
    """Runs a sweep's episodes in processes of this machine; see `Dispatcher`."""

    def _start(self) -> _Process:
        context = multiprocessing.get_context("spawn")
        own, other = context.Pipe()
        # Without the sweep: a child that is killed while it reads a long argument would block this process for ever.
        process = context.Process(target=_work, args=(other, os.getpid()), daemon=True)
        process.start()
        other.close()
        return _Process(self._sweep, process, own)

    def _heard(self, timeout: float) -> Collection[_Process]:
        connections = wait([worker.connection for worker in self._workers], timeout)
        return [worker for worker in self._workers if worker.connection in connections]


def _why(code: int | None) -> str:
    if code is None or code >= 0:
        return f" with exit code {code}"
    try:
        return f" by {signal.Signals(-code).name}"
    except ValueError:
        return f" by signal {-code}"


def _work(connection: Connection, parent: int) -> None:
    """Run the episodes of a sweep until the connection ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches all processes of a terminal
    _die_with(parent)
    with contextlib.suppress(EOFError, OSError):
        connection.send(None)  # an episode that it is given from here on may be the reason if it ends
        run: Callable[[Episode], Row] = Runner(connection.recv()).run
        while True:
            connection.send(run(connection.recv()))
    sys.stdout.flush()
    os._exit(0)


def _die_with(parent: int) -> None:
    """Let the system end this process with its parent, also where that is killed."""
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)
    if os.getppid() != parent:  # it has ended before
        os._exit(1)
