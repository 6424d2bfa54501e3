"""What publishes messages when it hears one: which messages it has heard, and when it publishes.

A message is heard between two steps: of a topic that the twin publishes at the times at which ROS would, and of any
other one when it comes. What it triggers is published at the start of the next step that is not before the delay's end,
in the thread that advances the twin, so that a run repeats to the last bit.
"""

import logging
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol

from drake_twin.diagram.topics import PublishedTopic
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.errors import CommandError, TwinError
from drake_twin.messages.draft import Draft
from drake_twin.messages.interface_types import make
from drake_twin.planning.triggers import OwnedTrigger, as_type
from drake_twin.twin.clock import Clock
from drake_twin.twin.endpoints import COMMANDED, PUBLISHED, TWIN_NODE, Endpoint
from drake_twin.twin.event_topics import EventTopics
from drake_twin.twin.schedule import step_at
from drake_twin.twin.subscriptions import Subscription, Subscriptions

if TYPE_CHECKING:
    from drake_twin.description.gz_requests import GzRequest
    from drake_twin.description.triggers import TriggeredMessage

_log = logging.getLogger(__name__)

_ANY, _TYPE_OF_ANY = "", "std_msgs/msg/Bool"  # of a trigger that hears any type, and of a topic that no other has
_DEPTH = 10
_MOST_PENDING = 10_000

Key = tuple[str, int]


class Publish(Protocol):
    """Publishes a command that is not recorded, as `drake_twin.twin.graph.Graph.deliver` does."""

    def __call__(self, topic: str, data: Any) -> None:
        """Publish it."""


class Triggers:
    """The triggers of a session.

    Args:
        clock: The time.
        events: The topics that no port of the diagram has; those of triggers are added to them.
        subscriptions: The callbacks of topics; those of triggers are added to them.

    Attributes:
        publish: Publishes a command.
        request: Does what a service of gz-sim's world does; its second argument is called with what is wrong.
        publication: Returns the time (s) at which a port's present message was published; None if it is new.
        endpoints: The topics that no controller listens to and a trigger hears.
        heard: Topic → the triggers that hear it.
        pending: Time (s), owner and number of each trigger that is to publish, in the order of what they have heard.
    """

    def __init__(self, clock: Clock, events: EventTopics, subscriptions: Subscriptions):
        self._clock, self._events, self._subscriptions = clock, events, subscriptions
        self.publish: Publish = lambda topic, data: None
        self.request: Callable[[GzRequest, Callable[[TwinError], None]], None] = lambda request, refuse: None
        self.publication: Callable[[str], Any] = lambda port: None
        self.endpoints: tuple[Endpoint, ...] = ()
        self.pending: list[tuple[float, str, int]] = []
        self._known: dict[Key, OwnedTrigger] = {}
        self.heard: dict[str, list[OwnedTrigger]] = {}
        self._ends: dict[str, Callable[[], None]] = {}
        self._published: Mapping[str, PublishedTopic] = {}
        self._types: dict[str, str] = {}
        self._before: list[tuple[float, str, int]] = []
        self._refused: dict[str, str] = {}

    def use(self, built: TwinDiagram, others: Sequence[Endpoint] = ()) -> None:
        """Switch to a newly built diagram; what is pending stays if its trigger does.

        Args:
            built: The diagram.
            others: Topics of the twin that no port has and that are published elsewhere.
        """
        self._known = {(item.owner, item.number): item for item in built.triggers}
        self.pending = [entry for entry in self.pending if entry[1:] in self._known]
        self.heard = {}
        for item in built.triggers:
            for topic in item.topics:
                self.heard.setdefault(topic, []).append(item)
        self._types = {item.topic: item.type for item in built.commanded.values()}
        published = built.publishers
        self._published = built.published
        for topic in [topic for topic in self._ends if topic not in published or topic not in self.heard]:
            self._ends.pop(topic)()
        for topic in sorted((self.heard.keys() & published.keys()) - self._ends.keys()):
            self._ends[topic] = self._follow(topic)
        known = {*published, *(item.name for item in others)}
        heard = {topic: self._type(topic) for topic in self.heard if topic not in known}
        self.endpoints = tuple(
            Endpoint(COMMANDED, topic, type_, TWIN_NODE) for topic, type_ in heard.items() if topic not in self._types
        )
        told = {message.topic: message.type for item in built.triggers for message in item.trigger.messages}
        taken = {*self._types, *heard, *known}
        more = (
            Endpoint(PUBLISHED, topic, type_, TWIN_NODE, depth=_DEPTH)
            for topic, type_ in told.items()
            if topic not in taken
        )
        self._events.use((*others, *more))

    def hears(self, topic: Any) -> bool:
        """Tell whether a message that is published to the twin may trigger something."""
        return isinstance(topic, str) and topic in self.heard

    def hear(self, topic: str, data: Any) -> None:
        """Take a message that is published to the twin.

        Args:
            topic: A topic that a trigger hears.
            data: A ROS message, or its fields as a mapping.

        Raises:
            CommandError: If the message does not fit the topic.
        """
        if topic not in self._types:
            self.take(topic, self.check(topic, data))
            return
        fields = data if isinstance(data, Mapping) or hasattr(data, "__msgtype__") else {"data": data}
        with suppress(TypeError, ValueError):  # its controller may refuse it
            self.take(topic, make(self._types[topic], fields))

    def check(self, topic: str, data: Any) -> Any:
        """Return data as a message of a topic.

        Raises:
            CommandError: If it does not fit the topic.
        """
        try:
            return make(self._type(topic), data)
        except (TypeError, ValueError) as error:
            raise CommandError(str(error)).about(topic) from None

    def _type(self, topic: str) -> str:
        """Return the type of a topic that nothing but triggers has in the twin."""
        types = (item.trigger.type for item in self.heard[topic] if item.trigger.type)
        return next(types, _TYPE_OF_ANY)

    def take(self, topic: str, message: Any) -> None:
        """Note what a message triggers that is on a topic."""
        kind = message.__msgtype__
        for item in self.heard.get(topic, ()):
            is_heard = item.trigger.type in (kind, _ANY) and item.trigger.hears(message)
            if is_heard and len(self.pending) < _MOST_PENDING:
                self.pending.append((self._clock.time + item.trigger.delay, item.owner, item.number))

    def apply(self) -> None:
        """Publish what is due at the present step."""
        due, self.pending = self.pending, []
        for time, owner, number in due:
            if step_at(time, self._clock.time_step) > self._clock.step:
                self.pending.append((time, owner, number))
                continue
            trigger = self._known[owner, number].trigger
            for message in trigger.messages:
                self._publish(message)
            for item in trigger.requests:
                if item.request is not None:
                    self.request(item.request, partial(self._refuse, item.service))

    def keep(self) -> None:
        """Note what is pending, for `take_back`."""
        self._before = [*self.pending]

    def take_back(self) -> None:
        """Forget what has been heard since `keep`: the step that was to follow has failed."""
        self.pending = [*self._before]

    def due_steps(self) -> list[float]:
        """Return the steps at which something is due."""
        present, step = self._clock.step, self._clock.time_step
        return [max(step_at(time, step), present + 1) for time, _, _ in self.pending]

    def start(self) -> None:
        """Forget what has been heard."""
        self.pending, self._before = [], []

    def state(self) -> dict[str, Any]:
        """Return the entry of a snapshot that this part keeps."""
        return {"triggered": [list(entry) for entry in self.pending]} if self.pending else {}

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set the entry that `state` returned.

        Raises:
            ValueError: If it is that of other triggers.
        """
        pending = [(float(time), str(owner), int(number)) for time, owner, number in state.get("triggered", ())]
        if any(entry[1:] not in self._known for entry in pending):
            raise ValueError("nothing there is triggered")
        self.pending = pending

    def _publish(self, message: "TriggeredMessage") -> None:
        topic = message.topic
        if topic in self._types:
            self._command(topic, as_type(self._types[topic], message))
        elif topic in self.heard:
            self.take(topic, make(message.type, message.fields))
        elif topic in self._events:
            self._events[topic].put(lambda: message.fields)

    def _command(self, topic: str, data: Any) -> None:
        try:
            self.publish(topic, data)
        except CommandError as error:
            self._refuse(topic, error)
        else:
            self._refused.pop(topic, None)

    def _refuse(self, name: str, error: TwinError) -> None:
        if self._refused.get(name) != str(error):  # once for each cause
            _log.warning("%s: %s" if name.startswith("/world/") else "%.0s%s", name, error)
        self._refused[name] = str(error)

    def _follow(self, topic: str) -> Callable[[], None]:
        """Hear a topic that the twin publishes."""
        return self._subscriptions.add_topic(topic, lambda port: self._subscription(topic, port))

    def _subscription(self, topic: str, port: str) -> Subscription:
        item = self._published[port]
        period = 1.0 / (item.rate or 1.0)

        def hear(draft: Draft) -> None:
            published = self.publication(port)
            is_new = published is None or published > self._clock.time - period + 1e-9
            if is_new and (message := draft.message()) is not None:
                self.take(topic, message)

        # Drafts are given at the points of the grid alone, so that a restored twin hears the same.
        return Subscription(port, hear, period, self._clock.time, takes_drafts=True, offset=item.offset)
