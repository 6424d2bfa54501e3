"""The engine of one machine: processes that each keep one built twin and get their episodes through a pipe."""

import contextlib
import signal
from collections.abc import Collection
from multiprocessing.connection import wait

from drake_twin.sweeps.dispatch import Dispatcher, Worker, WorkerEndedError
from drake_twin.sweeps.episode import Row, Sweep
from drake_twin.sweeps.processes import Processes, Started
from drake_twin.sweeps.variation import Episode


class _Process(Worker):
    """A process at the other end of a pipe."""

    def __init__(self, sweep: Sweep, started: Started):
        super().__init__()
        self._sweep, self._started, self.connection = sweep, started, started.connection

    @property
    def process(self) -> int | None:
        return self._started.process.pid

    def send(self, episode: Episode) -> None:
        with contextlib.suppress(OSError):  # it has died meanwhile, which its connection tells
            self.connection.send(episode)

    def receive(self) -> Row | None:
        try:
            row: Row | None = self.connection.recv()
        except (EOFError, OSError):
            self._started.process.join()
            raise WorkerEndedError(f"its process ended{_why(self._started.process.exitcode)}") from None
        if row is None:
            with contextlib.suppress(OSError):
                self.connection.send(self._sweep)
        return row

    def end(self) -> None:
        self._started.end()


class Engine(Dispatcher[_Process]):
    """Runs a sweep's episodes in processes of this machine; see `Dispatcher`.

    Args:
        sweep: The sweep.
        workers: The number of processes.
        timeout: The longest wall time of an episode (s).
        processes: Starts the processes; those that it has started ahead and are too many are ended.
    """

    def __init__(self, sweep: Sweep, workers: int, timeout: float, processes: Processes | None = None):
        self._starter = processes or Processes()
        self._starter.keep(workers)
        super().__init__(sweep, workers, timeout)

    def _start(self) -> _Process:
        return _Process(self._sweep, self._starter.take())

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
