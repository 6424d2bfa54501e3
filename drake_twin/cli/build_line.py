"""The line of the terminal that shows what is being built; without a terminal, lines about steps that take long."""

import contextlib
import sys
import threading
import time
from collections.abc import Iterator, Sequence

from drake_twin.program import say
from drake_twin.progress import heard

_PERIOD = 0.2  # s between two updates
_LONG = 2.0  # s, after which a step is said where no terminal shows it
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
    stopped_at = None
    steps = _Steps(is_shown=is_shown) if sys.stderr is not None else None

    def show(what: str) -> None:
        nonlocal stopped_at
        now = time.perf_counter()
        if stopped and stopped_at is None:
            stopped_at = now
        if stopped_at is not None and now - stopped_at > _PATIENCE:
            raise KeyboardInterrupt
        if steps is not None:
            steps.begin(what)

    try:
        with heard(show):
            yield
    finally:
        if steps is not None:
            steps.end()


class _Steps:
    """Says the steps that take long, from a thread of its own, while another one is busy with them.

    Args:
        is_shown: Whether there is a terminal, on whose line each step is shown that takes longer than `_PERIOD`.
    """

    def __init__(self, *, is_shown: bool):
        self._is_shown, self._stream = is_shown, sys.stderr  # which xacro has redirected meanwhile
        self._step, self._said, self._is_over = "", "", threading.Event()
        self._thread = threading.Thread(target=self._say, name="build_line", daemon=True)
        self._thread.start()

    def begin(self, what: str) -> None:
        """Begin the next step."""
        self._step = what

    def end(self) -> None:
        """Clear the line, and say nothing more."""
        self._is_over.set()
        self._thread.join()
        if self._is_shown:
            say("\r\033[K", self._stream, end="")

    def _say(self) -> None:
        while not self._is_over.wait(_PERIOD if self._is_shown else _LONG):
            if self._step == self._said:
                continue
            self._said = self._step
            before, end = ("\r\033[K", "") if self._is_shown else ("", "\n")
            say(f"{before}{self._said} …", self._stream, end=end)
