"""``/rosout``: lines of logs as ``rcl_interfaces/msg/Log``, those of the twin itself and those of node programs."""

import logging
import sys
from collections.abc import Callable
from typing import Any

from drake_twin.messages import time_message
from drake_twin.twin.event_topics import EventTopic

TWIN = "drake_twin"


def put_line(topic: EventTopic, *, time: float, level: int, name: str, text: str, place: tuple[str, str, int]) -> None:
    """Publish a line of a log, from any thread.

    Args:
        topic: ``/rosout``.
        time: Its simulation time (s).
        level: 10, 20, 30, 40 or 50, from debug to fatal.
        name: The logger's name: the node's full name, with dots for slashes.
        text: The text.
        place: The file, the function and the line that it comes from.
    """
    file, function, line = place

    def fields() -> dict[str, Any]:
        source = {"file": file, "function": function, "line": line}
        return {"stamp": time_message(time), "level": level, "name": name, "msg": text, **source}

    topic.put(fields)


def log_of(topic: EventTopic, now: Callable[[], float], node: str) -> Callable[[str], None]:
    """Return what publishes lines of level info in a node's name.

    Args:
        topic: ``/rosout``.
        now: Returns the simulation time (s).
        node: The node's full name.
    """
    name = node.strip("/").replace("/", ".")

    def tell(text: str) -> None:
        caller = sys._getframe(1)
        place = caller.f_code.co_filename, caller.f_code.co_name, caller.f_lineno
        put_line(topic, time=now(), level=logging.INFO, name=name, text=text, place=place)

    return tell


class TwinLog(logging.Handler):
    """Publish the package's own log records, while anybody subscribes.

    A record with a ``node``, the full name of a node of a robot, is that node's, such as one of its controller manager;
    others are the twin's.

    Args:
        topic: ``/rosout``.
        now: Returns the simulation time (s).
    """

    def __init__(self, topic: EventTopic, now: Callable[[], float]):
        super().__init__(logging.DEBUG)
        self._topic, self._now = topic, now
        topic.followed = self._follow

    def emit(self, record: logging.LogRecord) -> None:
        """Publish a record, from any thread."""
        name = str(getattr(record, "node", TWIN)).strip("/").replace("/", ".")
        level = min(max(record.levelno // 10, 1), 5) * 10
        if self._hides_last_resort() and logging.lastResort is not None and record.levelno >= logging.lastResort.level:
            logging.lastResort.handle(record)
        place = record.pathname, record.funcName or "", record.lineno
        put_line(self._topic, time=self._now(), level=level, name=name, text=record.getMessage(), place=place)

    def _hides_last_resort(self) -> bool:
        """Return whether Python would print the record itself if it were not for this handler."""
        own = logging.getLogger(TWIN).handlers
        is_first = next((item for item in own if isinstance(item, TwinLog)), None) is self
        return is_first and not logging.getLogger().handlers and all(isinstance(item, TwinLog) for item in own)

    def _follow(self, is_heard: bool) -> None:
        log = logging.getLogger(TWIN)
        (log.addHandler if is_heard else log.removeHandler)(self)
