"""The page's message line: what the package logs while a twin runs, and what was said when it was built."""

import logging
from collections import deque
from dataclasses import asdict, dataclass, replace
from typing import Any

_MOST = 200


@dataclass(frozen=True)
class LogLine:
    """A line for the page.

    Attributes:
        number: counts up; a line that comes again keeps its number.
        level: info, warning or error.
        text: what it says.
        time: simulation time (s); None for what was said before the start.
        times: how often it was said in a row.
    """

    number: int
    level: str
    text: str
    time: float | None = None
    times: int = 1


class MessageLog(logging.Handler):
    """Collects the package's log records and the page's own lines; the oldest are dropped.

    Attributes:
        version: grows with every line.
    """

    def __init__(self) -> None:
        super().__init__(logging.INFO)
        self.version = 0
        self.time: float | None = None
        self._lines: deque[LogLine] = deque(maxlen=_MOST)
        self._number = 0

    def emit(self, record: logging.LogRecord) -> None:
        """Takes a record of Python's logging, from whatever thread (logging holds the handler's lock)."""
        level = "error" if record.levelno >= logging.ERROR else record.levelname.lower()
        self.say(level, record.getMessage())

    def say(self, level: str, text: str) -> None:
        """Adds a line; the same one again only counts."""
        self.version += 1
        if self._lines and (self._lines[-1].level, self._lines[-1].text) == (level, text):
            last = self._lines[-1]
            self._lines[-1] = replace(last, time=self.time, times=last.times + 1)
            return
        self._number += 1
        self._lines.append(LogLine(self._number, level, text, self.time))

    def as_plain(self) -> list[dict[str, Any]]:
        """The lines, oldest first, as plain data."""
        return [asdict(line) for line in tuple(self._lines)]
