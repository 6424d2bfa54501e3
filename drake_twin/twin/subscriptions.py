"""The subscriptions to a twin's topics, and the times of their deliveries."""

from collections.abc import Callable, Iterable
from math import ceil, floor, inf
from operator import attrgetter
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.messages.draft import Draft
from drake_twin.twin.schedule import step_at

_due = attrgetter("due")


class Subscription:
    """A callback and the grid of simulation times at which it receives a topic's message.

    Args:
        topic: The topic.
        callback: Called with the message.
        period: The grid's spacing (s); None for a message that never changes, which is delivered once.
        time: The present time (s), at which the first message is delivered, but drafts are delivered on the grid only.
        takes_drafts: Whether the callback is given drafts of the messages.
        delay: How long after its measurement a message is delivered (s); it is measured at points of the grid only.
            None for at once.
        offset: The time of the first point of the grid (s).
        draft_at: Drafts the message of any time (s), if it follows from the time alone: the simulation does not have to
            stop for it, and it is delivered at the next stop.
        has_publications: Whether the topic's message may be an earlier one still, which is not delivered again.

    Attributes:
        due: The step of the next delivery, for the step length of the last `use`; infinite without one.
        is_latched: Whether its message never changes.
        delay: The delay (s).
        takes_drafts: Whether the callback is given drafts of the messages.
        draft_at: Drafts the message of any time (s); None if the simulation has to stop for it.
        has_publications: Whether the topic's message may be an earlier one still.
        publication: What tells the last message from the next one; None before the first.
    """

    def __init__(
        self,
        topic: str,
        callback: Callable[[Any], None],
        period: float | None,
        time: float,
        *,
        takes_drafts: bool = False,
        delay: float | None = None,
        offset: float = 0.0,
        draft_at: Callable[[float], Draft] | None = None,
        has_publications: bool = False,
    ):
        self.topic = topic
        self.callback = callback
        self.delay = delay
        self.draft_at = draft_at
        self.has_publications = has_publications
        self.due: float = 0
        self.is_latched = period is None
        self.takes_drafts = takes_drafts
        self.publication: Any = None
        self._offset = offset
        self._period = period or inf
        self._next_point = self._last_point_before(time)
        self._latched: Any = None
        self._is_volatile = False

    def use(self, time_step: float) -> None:
        """Count in steps of this length (s) from now on."""
        if self.is_latched:
            self.due = 0 if self._next_point == 0 else inf
        else:
            self.due = step_at(self._offset + self._next_point * self._period, time_step)

    def pass_step(self, step: int, time_step: float) -> None:
        """Count a delivery at a step of a length (s), and move on to the next grid point."""
        self._next_point += 1
        self.use(time_step)
        if self.due <= step:  # several points are at this step
            self._next_point = max(self._next_point, self._last_point_before(step * time_step) + 1)
            self.use(time_step)
            self.due = max(self.due, step + 1)

    def take(self, draft: Draft) -> None:
        """Deliver a message."""
        if self.is_latched:
            self._latched = draft.message()
        if self.takes_drafts:
            self.callback(draft)
        elif (message := draft.message()) is not None:
            self.callback(message)

    def look_again(self, message: Any) -> None:
        """Schedule another delivery if a message that should never change has, because its robot was replaced."""
        if self._next_point and message is not None and message != self._latched:
            self._next_point = 0

    def pass_over(self, message: Any) -> None:
        """Leave out the present message, if it is one that never changes."""
        if self.is_latched:
            self._latched, self._is_volatile, self._next_point = message, True, 1

    def begin(self, time: float) -> None:
        """Restart at a time (s) like a new subscription; call `use` afterwards."""
        self.publication = None
        self._next_point = 1 if self._is_volatile else self._last_point_before(time)

    def _last_point_before(self, time: float) -> int:
        """Return the last point of the grid that is not after a time; where only points count the first not before."""
        points = (time - self._offset) / self._period
        is_at_once = self.delay is None and not self.takes_drafts
        return floor(points + 1e-9) if is_at_once else ceil(points - 1e-9)


@dataclass
class _LateMessage:
    """A message that is measured already: its subscription, the time of its delivery (s), and its draft."""

    subscription: Subscription
    time: float
    draft: Draft


@dataclass(eq=False)
class _HeardTopic:
    """A topic with a subscription for each port that it has: their functions that end them, and what makes more."""

    topic: str
    subscription_of: Callable[[str], Subscription]
    ends: dict[str, Callable[[], None]]


class Subscriptions:
    """All subscriptions of a twin; callbacks are called in the order of the subscriptions.

    Args:
        time_step: The physics step (s).

    Attributes:
        ports_of: Returns the ports of a topic, which come and go with its publishers.
        read: Returns a reading of the present time.
        publication: Returns what tells a topic's message, as read, from an earlier one; None if it is new in any case.
        draft: Drafts a topic's message from a reading; None without a message, or for an unknown topic.
        due_step: The step at which the next delivery is due that the simulation has to stop for; infinite without one.
        is_caught_up: Whether no message comes without a stop.
    """

    def __init__(self, time_step: float):
        self.ports_of: Callable[[str], Iterable[str]] = lambda topic: ()
        self.read: Callable[[], Any] = lambda: None
        self.publication: Callable[[str, Any], Any] = lambda topic, reading: None
        self.draft: Callable[[str, Any], Draft | None] = lambda topic, reading: None
        self._time_step = time_step
        self._items: list[Subscription] = []
        self._stopping: list[Subscription] = []  # those of them that the simulation stops for
        self._late: list[_LateMessage] = []
        self._topics: list[_HeardTopic] = []
        self.due_step: float = inf
        self.is_caught_up = True

    def add(self, subscription: Subscription) -> Callable[[], None]:
        """Add a subscription; return a function that ends it."""
        self._items.append(subscription)
        self._note_stopping()
        subscription.use(self._time_step)
        self._note_due_step()
        return lambda: self._end(subscription)

    def add_topic(self, topic: str, subscription_of: Callable[[str], Subscription]) -> Callable[[], None]:
        """Subscribe to all ports of a topic, also to those that it gets later; return a function that ends it.

        Args:
            topic: The topic.
            subscription_of: Returns the subscription to one of its ports.
        """
        heard = _HeardTopic(topic, subscription_of, {})
        self._topics.append(heard)
        self._follow_ports()

        def end() -> None:
            if heard in self._topics:
                self._topics.remove(heard)
            for each in heard.ends.values():
                each()

        return end

    def _follow_ports(self) -> None:
        for heard in self._topics:
            for port in self.ports_of(heard.topic):
                if port not in heard.ends:
                    heard.ends[port] = self.add(heard.subscription_of(port))

    def use(self, time_step: float) -> None:
        """Count in steps of this length (s) from now on, and hear the ports that there are now."""
        self._time_step = time_step
        self._follow_ports()
        for subscription in self._items:
            subscription.use(time_step)
        self._note_due_step()

    def deliver(self, step: int) -> None:
        """Deliver the messages that are due at a step; callbacks may add and end subscriptions."""
        while self.due_step <= step:
            reading = self.read()
            drafts: dict[str, Draft | None] = {}
            for subscription in [item for item in self._stopping if item.due <= step]:
                if subscription.due > step:  # ended meanwhile
                    continue
                topic = subscription.topic
                subscription.pass_step(step, self._time_step)
                if subscription.has_publications:
                    publication = self.publication(topic, reading)
                    if publication is not None and publication == subscription.publication:
                        continue
                    subscription.publication = publication
                if topic not in drafts:
                    drafts[topic] = self.draft(topic, reading)
                if (draft := drafts[topic]) is None:
                    continue
                if subscription.delay is None:
                    subscription.take(draft)
                else:
                    self._late.append(_LateMessage(subscription, step * self._time_step + subscription.delay, draft))
            if self._late:
                self._deliver_late(step)
            self._note_due_step()

    def catch_up(self, step: int) -> None:
        """Deliver the messages up to a step for which the simulation does not stop."""
        for subscription in [item for item in self._items if item.draft_at is not None]:
            while subscription.draft_at is not None and subscription.due <= step:
                draft = subscription.draft_at(subscription.due * self._time_step)
                subscription.pass_step(int(subscription.due), self._time_step)
                subscription.take(draft)

    def _deliver_late(self, step: int) -> None:
        for late in [item for item in self._late if step_at(item.time, self._time_step) <= step]:
            if late in self._late:  # not ended meanwhile
                self._late.remove(late)
                if late.draft.message() is not None:  # made here, as it may wait for another process
                    late.subscription.take(late.draft)

    def begin(self, time: float) -> None:
        """Restart all subscriptions at a time (s); messages that are late are dropped."""
        self._late.clear()
        for subscription in self._items:
            subscription.begin(time)
        self.use(self._time_step)

    def look_again(self) -> None:
        """Deliver again the messages that should never change but have, because their robots were replaced."""
        for subscription in self._items:
            if subscription.is_latched:
                draft = self.draft(subscription.topic, self.read())
                subscription.look_again(None if draft is None else draft.message())
                subscription.use(self._time_step)
        self._note_due_step()

    def _end(self, subscription: Subscription) -> None:
        if subscription in self._items:
            self._items.remove(subscription)
            self._note_stopping()
            subscription.due = inf
            self._late = [item for item in self._late if item.subscription is not subscription]
            self._note_due_step()

    def _note_stopping(self) -> None:
        self._stopping = [item for item in self._items if item.draft_at is None]
        self.is_caught_up = len(self._stopping) == len(self._items)

    def _note_due_step(self) -> None:
        self.due_step = min(map(_due, self._stopping), default=inf)
        if self._late:
            self.due_step = min(self.due_step, *(step_at(item.time, self._time_step) for item in self._late))
