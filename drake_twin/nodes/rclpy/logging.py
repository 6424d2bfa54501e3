"""Stand-in for ``rclpy.logging``: lines as ROS prints them, with simulation time."""

import os
import sys
from enum import IntEnum
from types import FrameType
from typing import Any

from drake_twin.nodes.task import Task, here
from drake_twin.program import say
from drake_twin.twin.event_topics import ROSOUT
from drake_twin.twin.rosout import put_line


class LoggingSeverity(IntEnum):
    """How grave a line is."""

    UNSET = 0
    DEBUG = 10
    INFO = 20
    WARN = 30
    ERROR = 40
    FATAL = 50


class RcutilsLogger:
    """Prints the lines of a node."""

    def __init__(self, name: str = ""):
        self.name = name
        self._said: dict[tuple[str, int], int] = {}

    def get_child(self, name: str) -> "RcutilsLogger":
        child = RcutilsLogger(f"{self.name}.{name}" if self.name else name)
        published = _published()
        if self.name in published:
            published.add(child.name)
        return child

    def set_level(self, level: int) -> None:
        set_logger_level(self.name, level)

    def get_effective_level(self) -> LoggingSeverity:
        return get_logger_effective_level(self.name)

    def is_enabled_for(self, severity: int) -> bool:
        return severity >= self.get_effective_level()

    def log(
        self,
        message: Any,
        severity: int,
        *,
        once: bool = False,
        skip_first: bool = False,
        throttle_duration_sec: float | None = None,
        throttle_time_source_type: Any = None,
        name: str | None = None,
    ) -> bool:
        """Print a line, unless its level is too low or it comes too often."""
        if not self.is_enabled_for(severity):
            return False
        task = here()
        now = 0 if task is None else task.now
        if once or skip_first or throttle_duration_sec is not None:
            frame = _caller()
            key = frame.f_code.co_filename, frame.f_lineno
            before = self._said.get(key)
            if before is not None and once:
                return False
            if before is None and skip_first:
                self._said[key] = now
                return False
            if (
                throttle_duration_sec is not None
                and before is not None
                and 0 <= now - before < throttle_duration_sec * 1e9
            ):
                return False
            self._said[key] = now
        name = self.name if name is None else name
        place = f"{now // 1_000_000_000}.{now % 1_000_000_000:09d}] [{name}"
        say(f"[{LoggingSeverity(severity).name}] [{place}]: {message}", sys.stderr)
        if task is not None and name in _published():
            _publish(task, int(severity), name, str(message))
        return True

    def debug(self, message: Any, **options: Any) -> bool:
        return self.log(message, LoggingSeverity.DEBUG, **options)

    def info(self, message: Any, **options: Any) -> bool:
        return self.log(message, LoggingSeverity.INFO, **options)

    def warning(self, message: Any, **options: Any) -> bool:
        return self.log(message, LoggingSeverity.WARN, **options)

    warn = warning

    def error(self, message: Any, **options: Any) -> bool:
        return self.log(message, LoggingSeverity.ERROR, **options)

    def fatal(self, message: Any, **options: Any) -> bool:
        return self.log(message, LoggingSeverity.FATAL, **options)


def get_logger(name: str) -> RcutilsLogger:
    """Return a logger."""
    if not name:
        raise ValueError("Logger name must not be empty.")
    return RcutilsLogger(name)


def _caller() -> FrameType:
    """Return the frame that has called a logger."""
    frame = sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename == __file__:
        frame = frame.f_back
    return frame


def _publish(task: Task, level: int, name: str, text: str) -> None:
    """Publish a line on ``/rosout``."""
    frame = _caller()
    place = os.path.abspath(frame.f_code.co_filename), frame.f_code.co_name, frame.f_lineno
    topic = task.program.rclpy["graph"].twin.graph.events[ROSOUT]
    put_line(topic, time=task.now * 1e-9, level=level, name=name, text=text, place=place)


def _published() -> set[str]:
    """Return the names of the program's loggers whose lines are published: those of its nodes, and those below them."""
    task = here()
    names: set[str] = set() if task is None else task.program.rclpy.setdefault("rosout", set())
    return names


def publish_lines(name: str) -> None:
    """Publish the lines of a node's logger from now on."""
    _published().add(name)


def end_lines(name: str) -> None:
    """Publish the lines of a node's logger, and of those below it, no longer."""
    published = _published()
    published -= {item for item in published if item == name or item.startswith(f"{name}.")}


def _levels() -> dict[str, LoggingSeverity]:
    """Return the levels of the program's loggers, by their names; that of the root has none."""
    task = here()
    levels: dict[str, LoggingSeverity] = {} if task is None else task.program.rclpy.setdefault("log_levels", {})
    return levels


def set_logger_level(name: str, level: int, detailed_error: bool = False) -> None:
    """Set the level of all loggers of a name, and of those below it that have none of their own."""
    _levels()[name] = LoggingSeverity(level)


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """Return the level of a logger, or of the first one above it that has one."""
    if levels := _levels():
        names = name.split(".") if name else []
        for count in range(len(names), -1, -1):
            if level := levels.get(".".join(names[:count])):
                return level
    return LoggingSeverity.INFO


def get_logging_severity_from_string(log_severity: str) -> LoggingSeverity:
    """Return a level by its name.

    Raises:
        RuntimeError: If the name is unknown.
    """
    if log_severity.upper() not in LoggingSeverity.__members__:
        levels = ", ".join(LoggingSeverity.__members__).lower()
        raise RuntimeError(f"unknown log level {log_severity!r}. Valid: {levels}")
    return LoggingSeverity[log_severity.upper()]


def initialize() -> None:
    """Do nothing."""


def shutdown() -> None:
    """Do nothing."""


def clear_config() -> None:
    """Do nothing."""


_root_logger = RcutilsLogger()
