"""The process that looks ahead: ``python -m drake_twin.mirror.look_ahead_worker``.

It has a twin of its own, is told by a `Connection` what to simulate, and ends when the connection's other end does.
"""

import contextlib
import logging
import os
import sys
from multiprocessing.connection import Connection
from typing import Any

from drake_twin.errors import InputError, TwinError, described
from drake_twin.python_process import die_with, ignore_stops

READY, DONE, INVALID, FAILED = "ready", "done", "invalid", "failed"


def main(connection: str, parent: str) -> None:
    """Answer checks until the connection ends.

    Args:
        connection: The number of the connection's file.
        parent: The number of the process that has started this one, whose thread lives as long as it is needed.
    """
    die_with(int(parent))
    ignore_stops()
    logging.disable(logging.CRITICAL)  # a twin's warnings are about its files, or about what is noted as a problem
    with contextlib.suppress(EOFError, OSError):
        _work(Connection(int(connection)))
    sys.stdout.flush()
    os._exit(0)  # Drake's diagram need not be freed


def _work(link: Any) -> None:
    from drake_twin.mirror.run_ahead import run_ahead
    from drake_twin.twin.plain_data import from_plain
    from drake_twin.twin.twin import Twin

    try:
        twin = Twin(link.recv())
        first, step = twin.snapshot(), twin.clock.time_step
        run_ahead(twin, first, (), 5 * step)  # what is slow only once
    except TwinError as error:
        link.send((INVALID, str(error)))
        return
    link.send((READY, ""))
    while True:
        snapshot, commands, duration, allowed, longest_step = link.recv()
        try:
            verdict = run_ahead(twin, snapshot, from_plain(commands), duration, allowed, longest_step)
        except Exception as error:  # a fault of Drake's, or of this package: the next check restores another state
            invalid = isinstance(error, InputError)
            link.send((INVALID, str(error)) if invalid else (FAILED, " ".join(described(error).split())))
            continue
        link.send((DONE, verdict))
        if twin.clock.time_step != snapshot.time_step:  # while nobody waits: the next snapshot has such steps, too
            twin.restore(snapshot)


if __name__ == "__main__":
    main(*sys.argv[1:])
