"""The seam between a twin and any number of wires: the only place that knows both.

Out: a topic with listeners is subscribed to; its messages are handed to a thread that serializes each once
and gives the same bytes to all wires. In: what a wire hears is decoded in the wire's thread, waits in the twin's inbox,
and is done in the simulation's thread, by `Twin.publish` and the like, so that it is recorded.
"""

import contextlib
import logging
from collections.abc import Callable, Container, Generator, Iterable, Mapping, Sequence
from dataclasses import fields
from functools import partial
from time import monotonic
from typing import Any, Protocol

import numpy as np

from drake_twin.diagram.topics import CLOCK
from drake_twin.errors import TwinError
from drake_twin.messages.draft import Draft, LaterDraft
from drake_twin.messages.interface_types import definition, deserialize, make, make_response, serialize, type_hash
from drake_twin.twin.endpoints import COMMANDED, PUBLISHED, Endpoint, ServiceEndpoint
from drake_twin.twin.twin import Twin
from drake_twin.wires.outbox import OfferedTopic, Outbox
from drake_twin.wires.wire import (
    LARGEST,
    LARGEST_OF_NODES,
    AskingWire,
    Closable,
    Reply,
    ServiceClient,
    Wire,
    WireEndpoint,
    close_all,
)

_log = logging.getLogger(__name__)
_MOST_LINES = 1000  # of the log
_REPETITION = 0.1  # s of wall time between two messages of a paused clock
_SHARED = {item.name for item in fields(Endpoint)} & {item.name for item in fields(WireEndpoint)}
_TOO_MANY = "too many requests wait"


class WiredActions(Protocol):
    """What actions publish beside the diagram's topics."""

    def loaded(self, twin: Twin) -> Any:
        """Return a value that changes whenever services come and go without a spawn or a delete."""

    def absent(self, twin: Twin) -> Container[str]:
        """Return the nodes whose topics are not there yet."""

    def topics(self) -> Iterable[Endpoint]:
        """Return the topics of the present actions, after their services have been asked for."""

    def proceed(self) -> None:
        """Continue what takes longer, between two advances."""

    def news(self) -> Iterable[tuple[str, Mapping[str, Any]]]:
        """Return the messages that are due: their topics and their fields."""

    def hear(self, topic: str, message: Any) -> None:
        """Take a message that a wire has heard."""

    def kept(self, topic: str) -> Iterable[Any]:
        """Return the messages that late joiners get, of those published before the topic was offered."""

    def wanted(self) -> Iterable[Any]:
        """Return the services of other programs that are asked: their names, types and nodes."""

    def look_again(self) -> None:
        """Take note that such a service has come or gone."""


class Seam:
    """Connects a twin to wires, until it is closed.

    Args:
        twin: The twin.
        wires: The wires; they are closed with the seam.
        services: Returns the services of a twin with its present robots.
        actions: What the twin's actions publish.
    """

    def __init__(
        self,
        twin: Twin,
        wires: Sequence[Wire],
        services: Callable[[Twin], Iterable[ServiceEndpoint]] = lambda twin: (),
        actions: WiredActions | None = None,
    ):
        self._twin = twin
        self._wires = wires
        self._services_of = services
        self._actions = actions
        self._loaded: Any = None
        self._endpoints: tuple[Endpoint, ...] | None = None
        self._topics: dict[str, OfferedTopic] = {}
        self._heard: dict[str, tuple[Endpoint, list[Closable]]] = {}
        self._served: dict[str, tuple[ServiceEndpoint, list[Closable]]] = {}
        self._clients: dict[str, tuple[Any, list[ServiceClient]]] = {}
        self._commanded: set[str] = set()
        self._has_changed = False
        self._logged: set[tuple[str, str]] = set()
        self._next_repetition = 0.0
        self._outbox = Outbox(self._log)
        twin.inbox.open()
        twin.inbox.looks.append(self._look)
        self._look()

    def flush(self) -> None:
        """Wait until the pending messages are sent."""
        self._outbox.flush()

    def close(self) -> None:
        """Send the pending messages, and end the wires.

        Raises:
            RunError: If a wire has lost messages that it was to keep; the others are ended, too.
        """
        self._twin.inbox.looks.remove(self._look)
        self._twin.inbox.close()
        for topic in self._topics.values():
            if topic.end is not None:
                topic.end()
                topic.end = None
        self._outbox.close()  # before the topics end, so that their last messages are sent
        self._keep_topics(())
        close_all(self._wires)

    # What comes and goes ---------------------------------------------------------------------------------------------

    def _look(self) -> None:
        """Follow spawns and deletes, and who listens."""
        endpoints = self._twin.graph.endpoints
        loaded = None if self._actions is None else self._actions.loaded(self._twin)
        if endpoints is not self._endpoints or loaded != self._loaded:
            self._endpoints, self._loaded = endpoints, loaded
            self._keep_topics(endpoints)
            self._follow_listeners()
        self._repeat_clock()
        if self._actions is not None:
            self._actions.proceed()
            self._tell_news()

    def _keep_topics(self, endpoints: Sequence[Endpoint]) -> None:
        """Offer these endpoints, and the services, and no others."""
        if self._actions is not None and endpoints:
            absent = self._actions.absent(self._twin)
            endpoints = [item for item in endpoints if item.node not in absent]
        services = {item.name: item for item in self._services_of(self._twin)} if endpoints else {}
        of_actions = tuple(self._actions.topics()) if self._actions is not None and endpoints else ()
        offered = {item.name: item for item in (*endpoints, *of_actions) if item.kind == PUBLISHED}
        gone = [name for name, topic in self._topics.items() if offered.get(name) != topic.endpoint]
        self._forget([self._topics.pop(name) for name in gone])
        for name in offered.keys() - self._topics.keys():
            self._topics[name] = topic = OfferedTopic(offered[name], is_of_twin=offered[name] in endpoints)
            wired = _wired(offered[name])
            topic.senders += [wire.advertise(wired, self._note_listeners) for wire in self._wires]
            for message in self._actions.kept(name) if self._actions is not None and not topic.is_of_twin else ():
                self._hand_over(topic, LaterDraft(partial(_same, message)))
        commanded = {item.name: item for item in (*of_actions, *endpoints) if item.kind == COMMANDED}
        self._commanded = {item.name for item in endpoints if item.kind == COMMANDED}
        _close_missing(self._heard, commanded)
        for name in commanded.keys() - self._heard.keys():
            item = commanded[name]
            wired = _wired(item, LARGEST if name in self._commanded else LARGEST_OF_NODES)
            heard = partial(self._hear, wired)
            self._heard[name] = item, [wire.listen(wired, heard) for wire in self._wires]
        _close_missing(self._served, services)
        for name, (_, ends) in list(self._served.items()):
            self._served[name] = services[name], ends  # the newer one knows the present robot
        for name in services.keys() - self._served.keys():
            service = services[name]
            wired = WireEndpoint(name, service.type, type_hash(service.type), service.node)
            self._served[name] = service, [wire.serve(wired, partial(self._ask, name)) for wire in self._wires]
        wanted = {item.name: item for item in self._actions.wanted()} if self._actions is not None and endpoints else {}
        _close_missing(self._clients, wanted)
        for name in wanted.keys() - self._clients.keys():
            item = wanted[name]
            wired = WireEndpoint(name, item.type, type_hash(item.type), item.node)
            wires = [wire for wire in self._wires if isinstance(wire, AskingWire)]
            self._clients[name] = item, [wire.client(wired, self._note_services) for wire in wires]

    def _note_services(self) -> None:
        """Take note that a service of another program has come or gone, in a wire's thread."""
        if self._actions is not None:
            self._twin.inbox.put(self._actions.look_again)

    def _note_listeners(self, is_heard: bool) -> None:
        """Follow who listens, later, in the simulation's thread."""
        if not self._has_changed:
            self._has_changed = True
            if not self._twin.inbox.put(self._follow_listeners):  # it is full: the next change tells
                self._has_changed = False

    def _follow_listeners(self) -> None:
        self._has_changed = False
        for topic in self._topics.values():
            self._follow(topic)

    def _follow(self, topic: OfferedTopic) -> None:
        """Subscribe to a topic with listeners, and to no other."""
        is_heard = topic.is_of_twin and topic.is_heard
        if is_heard and topic.end is None:
            topic.end = self._twin.graph.subscribe_drafts(topic.endpoint.name, partial(self._hand_over, topic))
        elif not is_heard and topic.end is not None:
            topic.end()
            topic.end = None

    def _forget(self, topics: Sequence[OfferedTopic]) -> None:
        ends = [topic.end for topic in topics if topic.end is not None]
        for end in ends:
            end()
        if ends:
            self._outbox.flush()  # their last messages
        for topic in topics:
            for sender in topic.senders:
                sender.close()

    # Out -------------------------------------------------------------------------------------------------------------

    def _repeat_clock(self) -> None:
        """Send the time of a paused twin again and again, as Gazebo does: who comes late would wait for ever."""
        topic = self._topics.get(CLOCK)
        if topic is None or not self._twin.clock.paused or not topic.is_heard:
            return
        if (now := monotonic()) >= self._next_repetition:
            self._next_repetition = now + _REPETITION
            graph = self._twin.graph
            if (draft := graph.draft(CLOCK, graph.read())) is not None:
                self._hand_over(topic, draft, is_repeated=True)

    def _hand_over(self, topic: OfferedTopic, draft: Draft, *, is_repeated: bool = False) -> None:
        time = self._twin.time if draft.time is None else draft.time
        self._outbox.put(topic, draft, time, is_repeated=is_repeated)

    def _tell_news(self) -> None:
        """Publish what has happened to the actions' goals."""
        for name, content in () if self._actions is None else self._actions.news():
            topic = self._topics[name]
            if topic.is_heard:
                self._hand_over(topic, LaterDraft(partial(make, topic.endpoint.type, content)))

    def send(self, name: str, message: Any) -> None:
        """Send a message that a node program has published, if anybody listens."""
        topic = self._topics.get(name)
        if topic is not None and topic.is_heard:
            self._hand_over(topic, LaterDraft(lambda: message))

    # Services of others ----------------------------------------------------------------------------------------------

    def has_service(self, name: str, kind: str) -> bool:
        """Return whether another program offers a service that is asked."""
        return self._client(name, kind) is not None

    def ask(self, name: str, kind: str, request: Any, answered: Callable[[Any], None]) -> None:
        """Ask a service of another program; `answered` takes the response, in the simulation's thread."""
        if (client := self._client(name, kind)) is not None:
            client.ask(serialize(request), partial(self._answered, name, kind, answered))

    def _client(self, name: str, kind: str) -> ServiceClient | None:
        item, clients = self._clients.get(name, (None, []))
        return next((client for client in clients if client.is_there and item.type == kind), None)

    def _answered(self, name: str, kind: str, answered: Callable[[Any], None], data: bytes) -> None:
        """Decode a response, in a wire's thread."""
        try:
            response = deserialize(f"{kind}_Response", data)
        except ValueError as error:
            self._log(name, str(error), "decoding")
            return
        if not self._twin.inbox.put(partial(answered, response)):
            self._log(name, f"a response is lost: {_TOO_MANY}")

    # In --------------------------------------------------------------------------------------------------------------

    def _hear(self, topic: WireEndpoint, data: bytes) -> None:
        """Decode a message, in a wire's thread."""
        if len(data) > topic.largest:
            self._log(topic.name, f"a message of more than {topic.largest} bytes is ignored")
            return
        try:
            message = deserialize(topic.type, data)
        except ValueError as error:
            self._log(topic.name, str(error), "decoding")
            return
        act = partial(self._publish, topic.name, message)
        must_stay = len(data) <= LARGEST and _is_stop(message)
        if not self._twin.inbox.put(act, topic.name, must_stay=must_stay, size=len(data)):
            self._log(topic.name, "messages come faster than they are read: older ones are dropped")

    def _publish(self, topic: str, message: Any) -> None:
        if self._actions is not None:
            self._actions.hear(topic, message)
        if topic not in self._commanded:
            return
        try:
            self._twin.publish(topic, message)
        except TwinError as error:
            self._log(topic, str(error))

    def _ask(self, name: str, data: bytes, reply: Reply) -> None:
        """Decode a request, in a wire's thread."""
        if name not in self._served:  # it has just been taken off
            return
        service, _ = self._served[name]
        try:
            if len(data) > LARGEST:
                raise ValueError(f"a request of more than {LARGEST} bytes is ignored")
            request = deserialize(f"{service.type}_Request", data)
        except ValueError as error:
            self._refuse(service, reply, str(error), "decoding")
            return
        act = partial(self._answer, name, request, reply)
        if not self._twin.inbox.put(act, between_advances=service.between_advances):
            self._refuse(service, reply, _TOO_MANY)

    def _answer(self, name: str, request: Any, reply: Reply) -> None:
        """Answer a request, in the simulation's thread."""
        if name not in self._served:  # its robot was deleted while the request waited
            return
        service, _ = self._served[name]
        try:
            fields = service.answer(request)
            if service.between_advances:
                self._look()  # who asks for a spawn finds its topics on the graph when the answer is there
            if not isinstance(fields, Generator):
                self._reply(service, fields, reply)
                self._tell_news()  # a goal that ends within a frame has been seen to execute, too
                return
        except (TwinError, ValueError) as error:
            self._refuse(service, reply, str(error))
            return
        self._continue(service, fields, reply)

    def _continue(self, service: ServiceEndpoint, answer: Generator[Any, None, Any], reply: Reply) -> None:
        """Continue an answer that takes longer, once a look."""
        try:
            next(answer)
        except StopIteration as end:
            self._tell_news()  # an action's result comes after its last feedback and its status
            self._reply(service, end.value, reply)
            return
        except (TwinError, ValueError) as error:
            self._refuse(service, reply, str(error))
            return
        act, between = partial(self._continue, service, answer, reply), service.between_advances
        if not self._twin.inbox.put(act, between_advances=between, is_urgent=between):  # others wait for time to pass
            self._refuse(service, reply, _TOO_MANY)

    def _reply(self, service: ServiceEndpoint, fields: Any, reply: Reply) -> None:
        """Answer once what was published before is sent."""
        self._outbox.then(partial(reply, serialize(make_response(service.type, fields))))

    def _refuse(self, service: ServiceEndpoint, reply: Reply, reason: str, cause: str = "") -> None:
        self._log(service.name, reason, cause)
        reply(serialize(make_response(service.type, {}, reason)))

    def _log(self, topic: str, text: str, cause: str = "") -> None:
        """Log once per topic and cause."""
        key = topic, cause or text
        if key not in self._logged and len(self._logged) < _MOST_LINES:
            self._logged.add(key)
            _log.warning("%s: %s", topic, text)


def _wired(endpoint: Endpoint, largest: int = LARGEST) -> WireEndpoint:
    kind, text, its_hash = endpoint.type, "", ""
    with contextlib.suppress(ValueError):  # of a type that only the user's own controller knows
        its_hash = type_hash(kind)
        if "/action/" not in kind:  # rosbags has no text for what is made of an action's parts
            text = definition(kind)
    shared = {name: getattr(endpoint, name) for name in _SHARED}
    return WireEndpoint(hash=its_hash, definition=text, largest=largest, **shared)


def _same(message: Any) -> Any:
    return message


def _close_missing(known: dict[str, Any], wanted: Mapping[str, Any]) -> None:
    """Close and forget those that are not wanted any more, or with another type."""
    for name in [name for name, (item, _) in known.items() if name not in wanted or wanted[name].type != item.type]:
        for end in known.pop(name)[1]:
            end.close()


def _is_stop(message: Any) -> bool:
    """Tell whether all numbers of a command are zero."""
    if isinstance(message, np.ndarray):
        return not message.any()
    if isinstance(message, list):
        return all(map(_is_stop, message))
    if not hasattr(message, "__msgtype__"):
        return not isinstance(message, bool | int | float) or message == 0
    names = [name for name in vars(message) if name not in ("header", "layout", "stamp")]
    return all(_is_stop(getattr(message, name)) for name in names)
