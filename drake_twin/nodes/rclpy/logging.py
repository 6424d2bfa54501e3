"""Stand-in for ``rclpy.logging``: lines as ROS prints them, with simulation time."""

import os
import sys
from pathlib import Path
from types import FrameType
from typing import Any

from drake_twin.nodes.rclpy.impl.logging_filters import Call
from drake_twin.nodes.rclpy.impl.logging_levels import get_logger_effective_level as get_logger_effective_level
from drake_twin.nodes.rclpy.impl.logging_levels import get_logger_level as get_logger_level
from drake_twin.nodes.rclpy.impl.logging_levels import (
    get_logging_severity_from_string as get_logging_severity_from_string,
)
from drake_twin.nodes.rclpy.impl.logging_levels import levels
from drake_twin.nodes.rclpy.impl.logging_levels import set_logger_level as set_logger_level
from drake_twin.nodes.rclpy.impl.logging_severity import LoggingSeverity
from drake_twin.nodes.task import Task, here
from drake_twin.program import say
from drake_twin.twin.event_topics import ROSOUT
from drake_twin.twin.rosout import put_line


class RcutilsLogger:
    """Prints the lines of a node."""

    def __init__(self, name: str = ""):
        self.name = name
        self._calls: dict[tuple[Any, ...], Call] = {}

    def get_child(self, name: str) -> "RcutilsLogger":
        if not name:
            raise ValueError("Child logger name must not be empty.")
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
        return LoggingSeverity(severity) >= self.get_effective_level()

    def log(self, message: str | None, severity: int, **kwargs: Any) -> bool:
        """Print a line, unless its level is too low or it comes too often.

        Args:
            message: The text.
            severity: Its level.
            **kwargs: ``once``, ``skip_first``, ``throttle_duration_sec`` (s) with ``throttle_time_source_type`` (a
                clock), and ``name`` in place of the logger's.

        Raises:
            TypeError: If an option is unknown, or the message is not a text.
            ValueError: If the same line of the program has called with other options before.
        """
        if not self.is_enabled_for(severity):
            return False
        name = kwargs.pop("name", self.name)
        call = Call(name, LoggingSeverity(severity), kwargs)
        frame = _caller()
        place = frame.f_code.co_name, frame.f_code.co_filename, frame.f_lineno, frame.f_lasti
        known = self._calls.setdefault(place, call)
        if known is not call:
            known.check(call)
        if not known.is_due():
            return False
        task = here()
        now = 0 if task is None else task.now
        if message is None:  # what C prints
            message = "(null)"
        if not isinstance(message, str):
            raise TypeError(f"rclpy_logging_rcutils_log(): incompatible function arguments: {message!r} is not a str")
        shown = f"{now // 1_000_000_000}.{now % 1_000_000_000:09d}] [{name}"
        say(f"[{LoggingSeverity(severity).name}] [{shown}]: {message}", sys.stderr)
        if task is not None and name in _published():
            _publish(task, int(severity), name, message)
        return True

    def debug(self, message: str, **kwargs: Any) -> bool:
        return self.log(message, LoggingSeverity.DEBUG, **kwargs)

    def info(self, message: str, **kwargs: Any) -> bool:
        return self.log(message, LoggingSeverity.INFO, **kwargs)

    def warning(self, message: str, **kwargs: Any) -> bool:
        return self.log(message, LoggingSeverity.WARN, **kwargs)

    warn = warning

    def error(self, message: str, **kwargs: Any) -> bool:
        return self.log(message, LoggingSeverity.ERROR, **kwargs)

    def fatal(self, message: str, **kwargs: Any) -> bool:
        return self.log(message, LoggingSeverity.FATAL, **kwargs)


def get_logger(name: str) -> RcutilsLogger:
    """Return a logger."""
    if not name:
        raise ValueError("Logger name must not be empty.")
    return _root_logger.get_child(name)


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


def initialize() -> None:
    """Do nothing."""


def shutdown() -> None:
    """Do nothing."""


def clear_config() -> None:
    """Forget the levels of the program's loggers."""
    levels().clear()


def get_logging_directory() -> Path:
    """Return the folder in which ROS writes its logs."""
    if folder := os.environ.get("ROS_LOG_DIR"):
        return Path(folder)
    return Path(os.environ.get("ROS_HOME") or "~/.ros").expanduser() / "log"


_root_logger = RcutilsLogger()
