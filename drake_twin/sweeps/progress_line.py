"""The progress of a sweep: a bar of rich on a terminal, else a line now and then."""

import sys
import time
from typing import Any, TextIO, cast

from drake_twin.program import say
from drake_twin.sweeps.episode import ERROR, Row

_PERIOD = 10.0  # s between two lines without a terminal


class ProgressLine:
    """Shows how many episodes are done, the rate, the time left and the failures; a context manager.

    Args:
        total: The number of episodes.
        done: How many are done already.
    """

    def __init__(self, total: int, done: int):
        self._total, self._done, self._failed = total, done, 0
        self._first, self._start = done, time.monotonic()
        self._last = self._start
        self._bar: Any = None
        self._task: Any = None
        if sys.stderr is not None and sys.stderr.isatty():
            self._bar = _bar()

    def __enter__(self) -> "ProgressLine":
        if self._bar is not None:
            self._bar.start()
            self._task = self._bar.add_task("episodes", total=self._total, completed=self._done, failed=0)
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def show(self, row: Row) -> None:
        """Take note of a finished episode."""
        self._done += 1
        self._failed += row["outcome"] == ERROR
        now = time.monotonic()
        if self._bar is not None:
            self._bar.update(self._task, completed=self._done, failed=self._failed)
        elif now - self._last > _PERIOD:
            self._last = now
            rate = (self._done - self._first) / (now - self._start)
            left = (self._total - self._done) / rate
            failed = f", {self._failed} failed" if self._failed else ""
            say(f"{self._done} of {self._total} episodes, {rate:.3g}/s, {left:.0f} s left{failed}", sys.stderr)


def _bar() -> Any:
    try:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
    except ImportError:
        return None
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    return Progress(
        *columns, TextColumn("{task.fields[failed]} failed"), console=Console(file=cast(TextIO, _Terminal()))
    )


class _Terminal:
    """The terminal of standard error, which may be closed meanwhile."""

    def write(self, text: str) -> int:
        say(text, sys.stderr, end="")
        return len(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(sys.stderr, name)
