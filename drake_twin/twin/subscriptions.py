"""Who listens to a twin's topics, and when each is to be told."""

from collections.abc import Callable
from math import floor, inf
from typing import Any

from drake_twin.twin.schedule import step_at


class Subscription:
    """A callback and the grid of simulation times, from zero on, at which it is given a topic's message.

    Args:
        topic: The topic.
        callback: Is given the message.
        period: The grid's spacing (s); None for a message that never changes, which is delivered once.
        time: The present time (s); its message is delivered first.

    Attributes:
        due: The step of the next delivery, counted as `use` was told last; infinite when there is none.
        is_latched: Whether its message never changes.
    """

    def __init__(self, topic: str, callback: Callable[[Any], None], period: float | None, time: float):
        self.topic = topic
        self.callback = callback
        self.due: float = 0
        self.is_latched = period is None
        self._period = period or inf
        self._next_point = self._last_point_before(time)
        self._latched: Any = None

    def use(self, time_step: float) -> None:
        """Count in steps of a length (s) from now on."""
        if self.is_latched:
            self.due = 0 if self._next_point == 0 else inf
        else:
            self.due = step_at(self._next_point * self._period, time_step)

    def pass_step(self, step: int, time_step: float) -> None:
        """Note a delivery at a step of a length (s), and moves on to the grid point after it."""
        self._next_point += 1
        self.use(time_step)
        if self.due <= step:  # several points lie at this step
            self._next_point = max(self._next_point, self._last_point_before(step * time_step) + 1)
            self.use(time_step)
            self.due = max(self.due, step + 1)

    def take(self, message: Any) -> None:
        """Give a message to whoever listens."""
        if self.is_latched:
            self._latched = message
        self.callback(message)

    def look_again(self, message: Any) -> None:
        """Deliver a message that never changes once more when it has, as when its robot is another one."""
        if self._next_point and message is not None and message != self._latched:
            self.begin(0.0)

    def begin(self, time: float) -> None:
        """Begin again at a time (s), as if it had been made then; `use` is to follow."""
        self._next_point = self._last_point_before(time)

    def _last_point_before(self, time: float) -> int:
        """Return the last point of the grid that is not after a time."""
        return floor(time / self._period + 1e-9)


class Subscriptions:
    """All of a twin's subscriptions, told in the order in which they were made.

    Args:
        time_step: The physics step (s).

    Attributes:
        latest: Returns a topic's message at the present time; None when there is none, or no such topic.
        due_step: The step at which the next delivery is due; infinite when there is none.
    """

    def __init__(self, time_step: float, latest: Callable[[str], Any] = lambda topic: None):
        self.latest = latest
        self._time_step = time_step
        self._items: list[Subscription] = []
        self.due_step: float = inf

    def add(self, subscription: Subscription) -> Callable[[], None]:
        """Add one; returns a function that ends it."""
        self._items.append(subscription)
        subscription.use(self._time_step)
        self._note_due_step()
        return lambda: self._end(subscription)

    def use(self, time_step: float) -> None:
        """Count in steps of a length (s) from now on."""
        self._time_step = time_step
        for subscription in self._items:
            subscription.use(time_step)
        self._note_due_step()

    def deliver(self, step: int) -> None:
        """Deliver what is due at a step; callbacks may subscribe and end subscriptions, theirs and others'."""
        while self.due_step <= step:
            for subscription in [item for item in self._items if item.due <= step]:
                if subscription.due <= step:  # nobody has ended it
                    message = self.latest(subscription.topic)
                    subscription.pass_step(step, self._time_step)
                    if message is not None:
                        subscription.take(message)
            self._note_due_step()

    def begin(self, time: float) -> None:
        """Let all begin again at a time (s)."""
        for subscription in self._items:
            subscription.begin(time)
        self.use(self._time_step)

    def look_again(self) -> None:
        """Look whether messages that never change have, because their robots are others."""
        for subscription in self._items:
            if subscription.is_latched:
                subscription.look_again(self.latest(subscription.topic))
                subscription.use(self._time_step)
        self._note_due_step()

    def _end(self, subscription: Subscription) -> None:
        if subscription in self._items:
            self._items.remove(subscription)
            subscription.due = inf
            self._note_due_step()

    def _note_due_step(self) -> None:
        self.due_step = min([item.due for item in self._items], default=inf)
