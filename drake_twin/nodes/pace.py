"""The pace of loops that publish without a wait."""

from collections.abc import Callable
from typing import Any

from drake_twin.nodes.task import Task

_AT_ONCE = 12  # equal messages at one simulation time, after which it is a loop


class Pace:
    """Lets a loop that publishes the same message again and again, without a wait, go on step by step.

    On a robot such a loop ends when another thread has heard something; here that takes a step. A burst of messages
    that differ, or of a few that are equal, is published at once.

    Args:
        copied: Returns a message that shares nothing with the given one.
    """

    def __init__(self, copied: Callable[[Any], Any]):
        self._copied = copied
        self._time, self._count, self._last, self._is_loop = -1, 0, None, False

    def keep(self, message: Any, task: Task) -> None:
        """Note that a message has been published; wait for the next step in a loop."""
        now = task.now
        if now != self._time:
            # A loop continues at each step; `after` is half of one away.
            self._is_loop = self._is_loop and now - self._time <= 3 * (task.after - now)
            self._time, self._count, self._last = now, 0, self._copied(message) if self._is_loop else None
        elif self._last is not None and message == self._last:
            self._count += 1
            if self._is_loop or self._count >= _AT_ONCE:
                self._is_loop = True
                task.sleep(task.after)
        elif self._last is None and self._count < 2:
            self._count += 1
        else:
            self._count, self._last, self._is_loop = 2, self._copied(message), False
