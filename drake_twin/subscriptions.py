"""Who listens to a twin's topics, and when each is to be told."""

from collections.abc import Callable
from math import floor, inf
from typing import Any

from drake_twin.schedule import step_at


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

    @property
    def is_latched(self) -> bool:
        """Whether its message never changes."""
        return self._period is None

    def due_step(self, time_step: float) -> float:
        """The step of the next delivery; infinite when there is none."""
        if self._period is None:
            return 0 if self._next_point == 0 else inf
        return step_at(self._next_point * self._period, time_step)

    def pass_time(self, time: float) -> None:
        """Notes a delivery at a time (s), and moves on to the grid point after it."""
        self._next_point = max(self._next_point, self._last_point_before(time)) + 1

    def take(self, message: Any) -> None:
        """Gives a message to whoever listens."""
        if self.is_latched:
            self._latched = message
        self.callback(message)

    def look_again(self, message: Any) -> None:
        """Delivers a message that never changes once more when it has, as when its robot is another one."""
        if self.is_latched and self._next_point and message is not None and message != self._latched:
            self.begin(0.0)

    def begin(self, time: float) -> None:
        """Begins again at a time (s), as if it had been made then."""
        self._next_point = self._last_point_before(time)

    def _last_point_before(self, time: float) -> int:
        """The last point of the grid that is not after a time."""
        return 0 if self._period is None else floor(time / self._period + 1e-9)


class Subscriptions:
    """All of a twin's subscriptions, told in the order in which they were made.

    Args:
        latest: topic → its message at the present time; None when there is none, or no such topic.
    """

    def __init__(self, latest: Callable[[str], Any]):
        self._latest = latest
        self._items: list[Subscription] = []
        self._due_step: tuple[float, float] | None = None  # the time step and the step; looked at in every slice

    def add(self, subscription: Subscription) -> Callable[[], None]:
        """Adds one; returns a function that ends it."""
        self._items.append(subscription)
        self._due_step = None
        return lambda: self._end(subscription)

    def due_step(self, time_step: float) -> float:
        """The step at which the next delivery is due; infinite when there is none."""
        if self._due_step is None or self._due_step[0] != time_step:
            self._due_step = time_step, min((item.due_step(time_step) for item in self._items), default=inf)
        return self._due_step[1]

    def deliver(self, step: int, time_step: float) -> None:
        """Delivers what is due at a step; callbacks may subscribe and end subscriptions, theirs and others'."""
        while self.due_step(time_step) <= step:
            for subscription in [item for item in self._items if item.due_step(time_step) <= step]:
                if subscription in self._items:
                    message = self._latest(subscription.topic)
                    subscription.pass_time(step * time_step)
                    self._due_step = None
                    if message is not None:
                        subscription.take(message)

    def begin(self, time: float) -> None:
        """Lets all begin again at a time (s)."""
        self._due_step = None
        for subscription in self._items:
            subscription.begin(time)

    def look_again(self) -> None:
        """Looks whether messages that never change have, because their robots are others."""
        self._due_step = None
        for subscription in self._items:
            if subscription.is_latched:
                subscription.look_again(self._latest(subscription.topic))

    def _end(self, subscription: Subscription) -> None:
        if subscription in self._items:
            self._items.remove(subscription)
            self._due_step = None
