"""Topics that no port of the diagram has: a message comes when something happens, such as a line of a log.

Any thread may publish; subscribers are called in the thread that advances the twin.
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from typing import Any

from drake_twin.messages.draft import Draft, LaterDraft
from drake_twin.messages.interface_types import make
from drake_twin.twin.endpoints import PUBLISHED, TWIN_NODE, Endpoint
from drake_twin.twin.owner import Owned, Owner, any_thread

ROSOUT, PARAMETER_EVENTS, DIAGNOSTICS = "/rosout", "/parameter_events", "/diagnostics"

# With the quality of service that rcl, rclpy and diagnostic_updater have for them.
_ENDPOINTS = (
    Endpoint(
        PUBLISHED,
        ROSOUT,
        "rcl_interfaces/msg/Log",
        TWIN_NODE,
        latched=True,
        depth=1000,
        lifespan=10.0,
        of_all_nodes=True,
    ),
    Endpoint(
        PUBLISHED, PARAMETER_EVENTS, "rcl_interfaces/msg/ParameterEvent", TWIN_NODE, depth=1000, of_all_nodes=True
    ),
    Endpoint(PUBLISHED, DIAGNOSTICS, "diagnostic_msgs/msg/DiagnosticArray", TWIN_NODE, rate=1.0, depth=1),
)


class _Subscriber:
    def __init__(self, callback: Callable[[Any], None], depth: int, *, takes_drafts: bool):
        self.callback, self.takes_drafts = callback, takes_drafts
        self.waiting: deque[Draft] = deque(maxlen=depth)


class EventTopic(Owned, path="twin.graph.events[…]"):
    """A topic whose messages are published one by one.

    Args:
        owner: The thread that the twin belongs to.
        endpoint: The topic; of a latched one, late subscribers get the last messages.
        now: Returns the simulation time (s).
        note: Is called when a message waits for a subscriber.

    Attributes:
        endpoint: The topic.
        now: Returns the simulation time (s).
        is_heard: Whether anybody subscribes.
        followed: Is called with whether anybody subscribes, whenever that changes.
        report: Returns the fields of the present message, of a topic with a rate; its subscriptions are not here.
    """

    def __init__(self, owner: Owner, endpoint: Endpoint, now: Callable[[], float], note: Callable[[], None]):
        self._owner = owner
        self.endpoint = endpoint
        self.is_heard = False
        self.followed: Callable[[bool], None] = lambda is_heard: None
        self.report: Callable[[], Mapping[str, Any]] | None = None
        self.now, self._note = now, note
        self._subscribers: list[_Subscriber] = []
        self._kept: deque[tuple[float, Draft]] = deque(maxlen=endpoint.depth if endpoint.latched else 0)

    @any_thread
    def put(self, fields: Callable[[], Mapping[str, Any]]) -> None:
        """Publish a message, from any thread.

        Args:
            fields: Returns the message's fields, if it is needed, in any thread and at any time.
        """
        if not self.is_heard and not self.endpoint.latched:
            return
        draft = self._draft(fields)
        self._kept.append((self.now(), draft))
        for subscriber in tuple(self._subscribers):
            subscriber.waiting.append(draft)
            self._note()

    def subscribe(
        self, callback: Callable[[Any], None], *, drafts: bool = False, kept: bool = True
    ) -> Callable[[], None]:
        """Call back with the messages, first with those that are kept if wanted; return a function that ends it."""
        subscriber = _Subscriber(callback, self.endpoint.depth, takes_drafts=drafts)
        now, longest = self.now(), self.endpoint.lifespan or float("inf")
        if kept:
            subscriber.waiting.extend(draft for time, draft in tuple(self._kept) if 0 <= now - time <= longest)
        if subscriber.waiting:
            self._note()
        self._subscribers.append(subscriber)
        self._follow()

        def end() -> None:
            if subscriber in self._subscribers:
                self._subscribers.remove(subscriber)
                self._follow()

        return self._owner.guard("the end of a subscription", end)

    def latest(self) -> Any:
        """Return the present message, or the one that was published last; None where none is kept."""
        draft = self.present() or (self._kept[-1][1] if self._kept else None)
        return None if draft is None else draft.message()

    def present(self) -> Draft | None:
        """Draft the present message of a topic with a rate; None for others."""
        if self.report is None:
            return None
        fields = self.report()
        return self._draft(lambda: fields)

    def deliver(self) -> None:
        """Call back with the pending messages."""
        for subscriber in tuple(self._subscribers):
            for _ in range(len(subscriber.waiting)):
                draft = subscriber.waiting.popleft()
                if subscriber not in self._subscribers:  # it has ended meanwhile
                    break
                subscriber.callback(draft if subscriber.takes_drafts else draft.message())

    def close(self) -> None:
        """End all subscriptions."""
        self._subscribers.clear()
        self._follow()

    def _draft(self, fields: Callable[[], Mapping[str, Any]]) -> Draft:
        return LaterDraft(lambda: make(self.endpoint.type, fields()))

    def _follow(self) -> None:
        if (is_heard := bool(self._subscribers)) != self.is_heard:
            self.is_heard = is_heard
            self.followed(is_heard)


class EventTopics(Mapping[str, EventTopic]):
    """The topics by their names.

    Args:
        owner: The thread that the twin belongs to.
        now: Returns the simulation time (s).

    Attributes:
        is_waiting: Whether a message waits for a subscriber.
    """

    def __init__(self, owner: Owner, now: Callable[[], float]):
        self.is_waiting = False
        self._make = partial(EventTopic, owner, now=now, note=self._note)
        self._topics = {item.name: self._make(item) for item in _ENDPOINTS}

    def __getitem__(self, topic: str) -> EventTopic:
        return self._topics[topic]

    def __iter__(self) -> Iterator[str]:
        return iter(self._topics)

    def __len__(self) -> int:
        return len(self._topics)

    @property
    def endpoints(self) -> tuple[Endpoint, ...]:
        """The topics."""
        return tuple(topic.endpoint for topic in self._topics.values())

    def use(self, endpoints: Iterable[Endpoint]) -> None:
        """Have these topics beside the twin's own, and no others."""
        known, self._topics = self._topics, {item.name: self._topics[item.name] for item in _ENDPOINTS}
        for item in endpoints:
            before = known.get(item.name)
            is_same = before is not None and before.endpoint == item
            self._topics.setdefault(item.name, before if before is not None and is_same else self._make(item))
        for name, topic in known.items():
            if self._topics.get(name) is not topic:
                topic.close()

    def deliver(self) -> None:
        """Call back with the pending messages, in the thread that advances the twin."""
        if self.is_waiting:
            self.is_waiting = False
            for topic in self._topics.values():
                topic.deliver()

    def close(self) -> None:
        """End all subscriptions."""
        for topic in self._topics.values():
            topic.close()

    def _note(self) -> None:
        self.is_waiting = True
