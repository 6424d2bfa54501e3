"""Processes that run episodes. They can be started before it is known what they run, as importing Drake takes longest.

That is why this module imports nothing of Drake but in these processes.
"""

import contextlib
import multiprocessing
import os
import sys
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from typing import NamedTuple, Self

from drake_twin.python_process import die_with, end_module_search, ignore_stops, same_module_search, stops_held_back


class Started(NamedTuple):
    """A process that was started.

    It sends None when it is ready, receives the sweep and then episodes, and sends the row of each.
    """

    process: SpawnProcess
    connection: Connection

    def end(self) -> None:
        """End it, whatever it does."""
        self.connection.close()
        self.process.kill()
        self.process.join()


class Processes:
    """Starts processes, some of them ahead; a context manager that ends those that nobody has taken.

    Args:
        ahead: The number of processes to start at once.
    """

    def __init__(self, ahead: int = 0):
        self._waiting: list[Started] = []
        for _ in range(ahead):
            self._waiting.append(_start())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.keep(0)

    def keep(self, count: int) -> None:
        """End those that wait but for so many."""
        while len(self._waiting) > count:
            self._waiting.pop().end()

    def take(self) -> Started:
        """Return a process that waits, or else a new one, which the caller ends."""
        return self._waiting.pop(0) if self._waiting else _start()


def _start() -> Started:
    context = multiprocessing.get_context("spawn")
    own, other = context.Pipe()
    # Without the sweep: a child that is killed while it reads a long argument would block this process for ever.
    process = context.Process(target=_work, args=(other, os.getpid()), daemon=True)
    with same_module_search():
        resource_tracker.ensure_running()  # `start` would do it, and let signals through again
        with stops_held_back():
            process.start()
    other.close()
    return Started(process, own)


def _work(connection: Connection, parent: int) -> None:
    """Run the episodes of a sweep until the connection ends."""
    ignore_stops()
    die_with(parent)
    end_module_search()
    try:
        from drake_twin.sweeps.episode import Runner
    except Exception:  # the sweep's own process fails in the same way, and says why
        os._exit(1)
    with contextlib.suppress(EOFError, OSError):
        connection.send(None)  # an episode that it is given from here on may be the reason if it ends
        run = Runner(connection.recv()).run
        while True:
            connection.send(run(connection.recv()))
    sys.stdout.flush()
    os._exit(0)
