"""Processes that run episodes, and the one that hands them out.

Each process keeps one built twin. An episode is given to one process at a time, so that the episode of a process that
dies or hangs is known; it is given out once more, and then is a row with its reason. (A pool of `concurrent.futures`
cannot say whose episode broke it: it fails all of them.)
"""

import contextlib
import ctypes
import multiprocessing
import os
import signal
import sys
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Any

from drake_twin.errors import RunError
from drake_twin.sweeps.episode import ERROR, Row, Runner, Sweep, failed
from drake_twin.sweeps.variation import Episode

TRIES = 2
_FAILED_STARTS = 20  # in a row
_LOOK = 0.2  # s between two looks at signals and deadlines
_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG of Linux's prctl


def workers_of_machine() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@dataclass
class _Worker:
    """A process, and the episode that it runs."""

    process: SpawnProcess
    connection: Connection
    is_ready: bool = False
    episode: Episode | None = None
    deadline: float = 0.0


class Engine:
    """Runs a sweep's episodes in processes; a context manager that ends them.

    Args:
        sweep: The sweep.
        workers: The number of processes.
        timeout: The longest wall time of an episode (s).
    """

    def __init__(self, sweep: Sweep, workers: int, timeout: float):
        self._sweep, self._timeout = sweep, timeout
        self._failed_starts = 0
        self._workers = [self._start() for _ in range(workers)]

    def __enter__(self) -> "Engine":
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._workers:
            self._end(worker)

    @property
    def processes(self) -> list[int]:
        """The ids of the processes."""
        return [worker.process.pid for worker in self._workers if worker.process.pid is not None]

    def rows(self, episodes: Iterator[Episode], stopped: Sequence[Any] = ()) -> Iterator[Row]:
        """Yield the rows of episodes as they come, in any order.

        Args:
            episodes: The episodes to run.
            stopped: Ends the sweep when there is something in it; running episodes are dropped.
        """
        again: deque[Episode] = deque()
        tries: dict[int, int] = {}

        def following() -> Episode | None:
            return again.popleft() if again else next(episodes, None)

        upcoming = following()
        while not stopped and (upcoming is not None or any(worker.episode for worker in self._workers)):
            for worker in self._workers:
                if upcoming is not None and worker.is_ready and worker.episode is None:
                    self._give(worker, upcoming)
                    upcoming = following()
            connections = wait([worker.connection for worker in self._workers], _LOOK)
            for worker in self._workers:
                episode, row = worker.episode, self._result(worker, has_sent=worker.connection in connections)
                if row is None or episode is None:
                    continue
                worker.episode = None
                tries[episode.number] = tries.get(episode.number, 0) + 1
                if row["outcome"] == ERROR and tries[episode.number] < TRIES:
                    again.append(episode)
                    upcoming = upcoming or following()
                    continue
                del tries[episode.number]
                if upcoming is not None and worker.is_ready:  # it runs while this row is written
                    self._give(worker, upcoming)
                    upcoming = following()
                yield row

    def _start(self) -> _Worker:
        context = multiprocessing.get_context("spawn")
        own, other = context.Pipe()
        # Without the sweep: a child that is killed while it reads a long argument would block this process for ever.
        process = context.Process(target=_work, args=(other, os.getpid()), daemon=True)
        process.start()
        other.close()
        return _Worker(process, own)

    def _end(self, worker: _Worker) -> None:
        worker.connection.close()
        worker.process.kill()
        worker.process.join()

    def _give(self, worker: _Worker, episode: Episode) -> None:
        worker.episode, worker.deadline = episode, time.monotonic() + self._timeout
        with contextlib.suppress(OSError):  # it has died meanwhile, which its connection tells
            worker.connection.send(episode)

    def _result(self, worker: _Worker, *, has_sent: bool) -> Row | None:
        """Return the row of a process, or that of its end; None while it runs or starts.

        Raises:
            RunError: If several processes have ended before they could begin.
        """
        if has_sent:
            try:
                row: Row | None = worker.connection.recv()
            except (EOFError, OSError):
                worker.process.join()
                return self._replace(worker, f"its process ended{_why(worker.process.exitcode)}")
            if row is None:
                worker.is_ready, self._failed_starts = True, 0
                with contextlib.suppress(OSError):
                    worker.connection.send(self._sweep)
            return row
        if worker.episode is not None and time.monotonic() > worker.deadline:
            return self._replace(worker, f"no result within {self._timeout:g} s")
        return None

    def _replace(self, worker: _Worker, reason: str) -> Row | None:
        """Start a process in place of one that has died or hangs, and return the row of its episode, if it had one."""
        self._failed_starts += not worker.is_ready
        if self._failed_starts > _FAILED_STARTS:
            raise RunError(f"the processes of the sweep cannot start: {reason}")
        episode = worker.episode
        self._end(worker)
        new = self._start()
        worker.process, worker.connection, worker.is_ready = new.process, new.connection, False
        return None if episode is None else failed(self._sweep, episode, f"{reason} (in {TRIES} tries)")


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
