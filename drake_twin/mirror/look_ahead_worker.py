"""The process that looks ahead: ``python -m drake_twin.mirror.look_ahead_worker``.

It has a twin of its own, is told by a `Connection` what to simulate, and ends when the connection's other end does.
"""

import contextlib
import logging
import os
import sys
from multiprocessing.connection import Connection
from typing import Any

from drake_twin.errors import TwinError
from drake_twin.python_process import ignore_stops

READY, DONE, INVALID = "ready", "done", "invalid"


def main(connection: str) -> None:
    """Answer checks until the connection ends.

    Args:
        connection: The number of the connection's file.
    """
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
        except TwinError as error:
            link.send((INVALID, str(error)))
            continue
        link.send((DONE, verdict))
        if twin.clock.time_step != snapshot.time_step:  # while nobody waits: the next snapshot has such steps, too
            twin.restore(snapshot)


if __name__ == "__main__":
    main(*sys.argv[1:])
