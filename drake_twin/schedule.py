"""What a twin has to stop for between physics steps: commands that fall due, and messages that are to be delivered.

Times are met at physics steps: something due at a time happens at the first step that is not before it.
"""

from collections.abc import Callable
from math import ceil, floor, inf
from typing import Any

from drake_twin.scenario import Command

_ROUNDING = 1e-6  # of a step: k · 0.001 differs from its literal for one k in eight


def step_at(time: float, time_step: float) -> int:
    """The first physics step that is not before a time (s)."""
    return ceil(time / time_step - _ROUNDING)


class Subscription:
    """A callback and the grid of simulation times, from zero on, at which it is given a topic's message.

    Args:
        topic: the topic.
        callback: is given the message.
        period: the grid's spacing (s); None for a message that never changes, which is delivered once.
        time: the present time (s); its message is delivered first.
    """

    def __init__(self, topic: str, callback: Callable[[Any], None], period: float | None, time: float):
        self.topic = topic
        self.callback = callback
        self._period = period
        self._next_point = self._last_point_before(time)
        self._latched: Any = None

    def due_step(self, time_step: float) -> float:
        """The step of the next delivery; infinite when there is none."""
        if self._period is None:
            return 0 if self._next_point == 0 else inf
        return step_at(self._next_point * self._period, time_step)

    def pass_time(self, time: float) -> None:
        """Notes a delivery at a time (s), and moves on to the grid point after it."""
        self._next_point = self._last_point_before(time) + 1

    def take(self, message: Any) -> None:
        """Gives a message to whoever listens."""
        if self._period is None:
            self._latched = message
        self.callback(message)

    def look_again(self, message: Any) -> None:
        """Delivers a message that never changes once more when it has, as when its robot is another one."""
        if self._period is None and self._next_point and message is not None and message != self._latched:
            self.begin(0.0)

    def begin(self, time: float) -> None:
        """Begins again at a time (s), as if it had been made then."""
        self._next_point = self._last_point_before(time)

    def _last_point_before(self, time: float) -> int:
        """The last point of the grid that is not after a time."""
        return 0 if self._period is None else floor(time / self._period + 1e-9)


class ScheduledCommand:
    """A scenario's command and the step at which it is next due.

    Args:
        command: what to publish when.

    Attributes:
        topic: where it is published.
        data: what.
        published: how often it has been.
    """

    def __init__(self, command: Command):
        self.topic = command.topic
        self.data = command.data
        self.published = 0
        self._command = command

    def due_step(self, time_step: float) -> float:
        """The step at which it is next published; infinite when it has been for the last time."""
        if self._command.period is None:
            return inf if self.published else step_at(self._command.time, time_step)
        return step_at(self._command.time + self.published * self._command.period, time_step)

    def pass_step(self) -> None:
        """Notes that it was published."""
        self.published += 1
