"""Workers that run episodes, and what hands the episodes out to them, whatever runs the workers.

An episode is given to one worker at a time, so that the episode of a worker that dies or hangs is known; it is given
out once more, and then is a row with its reason. (A pool of `concurrent.futures` cannot say whose episode broke it: it
fails all of them.)
"""

import time
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Collection, Iterator, Sequence
from typing import Any, Generic, Self, TypeVar

from drake_twin.errors import RunError, TwinError
from drake_twin.sweeps.episode import ERROR, Row, Sweep, failed
from drake_twin.sweeps.variation import Episode

TRIES = 2
_FAILED_STARTS = 20  # in a row
_LOOK = 0.2  # s between two looks at signals and deadlines


class WorkerEndedError(TwinError):
    """Raised when a worker has ended; the text says how."""


class Worker(ABC):
    """A process that runs episodes, one at a time.

    Attributes:
        is_ready: Whether it has started.
        episode: What it runs.
        deadline: The time at which it is taken to hang, of `time.monotonic` (s).
    """

    def __init__(self) -> None:
        self.is_ready = False
        self.episode: Episode | None = None
        self.deadline = 0.0

    @property
    @abstractmethod
    def process(self) -> int | None:
        """The id of its process on its machine; None while it is unknown."""

    @abstractmethod
    def send(self, episode: Episode) -> None:
        """Send an episode; what goes wrong is seen when the row is received."""

    @abstractmethod
    def receive(self) -> Row | None:
        """Return the row that it has sent; None if it has started and is ready for an episode.

        Raises:
            WorkerEndedError: If it has ended.
        """

    @abstractmethod
    def end(self) -> None:
        """End the process, whatever it does."""


AnyWorker = TypeVar("AnyWorker", bound=Worker)


class Dispatcher(ABC, Generic[AnyWorker]):
    """Runs a sweep's episodes in workers; a context manager that ends them.

    Args:
        sweep: The sweep.
        workers: The number of workers.
        timeout: The longest wall time of an episode (s).
    """

    def __init__(self, sweep: Sweep, workers: int, timeout: float):
        self._sweep, self._timeout = sweep, timeout
        self._failed_starts = 0
        self._workers = [self._start() for _ in range(workers)]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._workers:
            worker.end()

    @property
    def processes(self) -> list[int]:
        """The ids of the workers' processes."""
        return [worker.process for worker in self._workers if worker.process is not None]

    @abstractmethod
    def _start(self) -> AnyWorker:
        """Start a worker."""

    @abstractmethod
    def _heard(self, timeout: float) -> Collection[AnyWorker]:
        """Return the workers that have sent something or ended, as soon as there are some (timeout in s)."""

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
            heard = self._heard(_LOOK)
            for place, worker in enumerate(self._workers):
                episode, row = worker.episode, self._result(place, has_sent=worker in heard)
                if row is None or episode is None:
                    continue
                worker.episode = None
                tries[episode.number] = tries.get(episode.number, 0) + 1
                if row["outcome"] == ERROR and tries[episode.number] < TRIES:
                    again.append(episode)
                    upcoming = upcoming or following()
                    continue
                del tries[episode.number]
                present = self._workers[place]
                if upcoming is not None and present.is_ready:  # it runs while this row is written
                    self._give(present, upcoming)
                    upcoming = following()
                yield row

    def _give(self, worker: AnyWorker, episode: Episode) -> None:
        worker.episode, worker.deadline = episode, time.monotonic() + self._timeout
        worker.send(episode)

    def _result(self, place: int, *, has_sent: bool) -> Row | None:
        """Return the row of a worker, or that of its end; None while it runs or starts."""
        worker = self._workers[place]
        if has_sent:
            try:
                row = worker.receive()
            except WorkerEndedError as error:
                return self._replace(place, str(error))
            if row is None:
                worker.is_ready, self._failed_starts = True, 0
            return row
        if worker.episode is not None and time.monotonic() > worker.deadline:
            return self._replace(place, f"no result within {self._timeout:g} s")
        return None

    def _replace(self, place: int, reason: str) -> Row | None:
        """Start a worker in place of one that has died or hangs, and return the row of its episode, if it had one.

        Raises:
            RunError: If several workers have ended before they could begin.
        """
        worker = self._workers[place]
        self._failed_starts += not worker.is_ready
        if self._failed_starts > _FAILED_STARTS:
            raise RunError(f"the processes of the sweep cannot start: {reason}")
        worker.end()
        self._workers[place] = self._start()
        episode = worker.episode
        return None if episode is None else failed(self._sweep, episode, f"{reason} (in {TRIES} tries)")
