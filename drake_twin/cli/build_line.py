"""The line of the terminal that shows what is being built."""

import contextlib
import sys
import time
from collections.abc import Iterator, Sequence

from drake_twin.program import say
from drake_twin.progress import heard

_PERIOD = 0.2  # s between two updates
_PATIENCE = 0.3  # s from a signal on, within which a twin is still built, so that it writes its summary


@contextlib.contextmanager
def build_line(stopped: Sequence[int]) -> Iterator[None]:
    """Show the progress of what is built inside the block, and end it when a signal arrives and it takes long.

    Args:
        stopped: The signals that have arrived.

    Raises:
        KeyboardInterrupt: If a signal has arrived, and the twin is not built shortly after it.
    """
    is_shown = sys.stderr is not None and sys.stderr.isatty()
    last, stopped_at = time.perf_counter(), None

    def show(what: str) -> None:
        nonlocal last, stopped_at
        now = time.perf_counter()
        if stopped and stopped_at is None:
            stopped_at = now
        if stopped_at is not None and now - stopped_at > _PATIENCE:
            raise KeyboardInterrupt
        if is_shown and now - last > _PERIOD:
            last = now
            say(f"\r\033[K{what} …", sys.stderr, end="")

    try:
        with heard(show):
            yield
    finally:
        if is_shown:
            say("\r\033[K", sys.stderr, end="")
