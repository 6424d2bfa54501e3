"""The page's messages: logs of the package and of node programs, and what was found when the twin was built."""

import logging
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import drake_twin
from drake_twin.dataclass import dataclass
from drake_twin.twin.event_topics import ROSOUT
from drake_twin.twin.rosout import TWIN
from drake_twin.twin.twin import Twin

_MOST = 200
_LEVELS = {20: "info", 30: "warning", 40: "error", 50: "error"}
_OWN = Path(drake_twin.__file__).parent
_PROGRAMS = _OWN / "nodes" / "programs"


@dataclass(frozen=True)
class LogLine:
    """One message.

    Attributes:
        number: Counts the messages; a repeated message keeps its number.
        level: ``info``, ``warning``, ``error`` or the kind of a finding.
        text: The text.
        time: Simulation time (s) of the last time; None for a message from before the start.
        times: How often the message occurred.
    """

    number: int
    level: str
    text: str
    time: float | None = None
    times: int = 1


class MessageLog(logging.Handler):
    """Collects the package's log records, lines of node programs and the page's own messages; the oldest are dropped.

    Attributes:
        version: Grows with every message.
        time: The simulation time that new messages are given (s).
    """

    def __init__(self) -> None:
        super().__init__(logging.INFO)
        self.version = 0
        self.time: float | None = None
        self._lines: dict[tuple[str, str], LogLine] = {}
        self._number = 0

    def follow(self, twin: Twin) -> Callable[[], None]:
        """Collect what the package and a twin's node programs log; return what ends it, which keeps the twin."""
        log = logging.getLogger(drake_twin.__name__)
        log.addHandler(self)
        end_lines = twin.subscribe(ROSOUT, self._add_line)

        def end() -> None:
            log.removeHandler(self)
            end_lines()

        return end

    def _add_line(self, line: Any) -> None:
        """Add a line of ``/rosout``; those that the package has logged are here already."""
        file = Path(line.file)
        is_own = line.name == TWIN or (file.is_relative_to(_OWN) and not file.is_relative_to(_PROGRAMS))
        if line.level in _LEVELS and not is_own:
            self.add(_LEVELS[line.level], f"{line.name}: {line.msg}")

    def emit(self, record: logging.LogRecord) -> None:
        """Add a log record, from any thread (logging holds the handler's lock)."""
        level = "error" if record.levelno >= logging.ERROR else record.levelname.lower()
        self.add(level, record.getMessage())

    def add(self, level: str, text: str) -> None:
        """Add a message; a repeated one is counted where it stands, and an error, which answers a press, comes last."""
        assert self.lock is not None
        with self.lock:
            self.version += 1
            line = self._lines.get((level, text))
            if line is None:
                self._number += 1
                line = LogLine(self._number, level, text, times=0)
            elif level == "error":
                del self._lines[level, text]
            self._lines[level, text] = replace(line, time=self.time, times=line.times + 1)
            if len(self._lines) > _MOST:
                del self._lines[next(iter(self._lines))]

    def as_plain(self) -> list[dict[str, Any]]:
        """Return the messages, oldest first, as plain data."""
        return [asdict(line) for line in tuple(self._lines.values())]
