"""Endpoints on nodes of rclpy, in the process of the machine's ROS 2: topics as bytes, services by their classes."""

import itertools
import time
from collections import deque
from collections.abc import Iterable
from typing import Any, Protocol

from drake_twin.wires.rclpy_classes import check_fields, class_of
from drake_twin.wires.rclpy_records import HEARD, MESSAGE, REQUEST, RESPONSE, Pipe

_MOST_TAKEN = 100  # messages of a subscription, until others have their turn
_LONGEST_ECHO = 1.0  # s in which a message that the twin publishes comes back to it
_REQUESTS = 1000  # that wait, as rmw_qos_profile_parameters has it: those of many clients come at once


class OfGraph(Protocol):
    """What endpoints need of the graph that they are on.

    Attributes:
        pipe: Where the twin is told.
        lock: The lock of its endpoints.
    """

    pipe: Pipe
    lock: Any

    def node(self, name: str) -> Any:
        """Return the node of a full name for another endpoint."""

    def own_subscriptions(self, name: str) -> Iterable["Subscription"]:
        """Return the twin's subscriptions of a topic."""


class Endpoint:
    """One end of a topic or a service on a node.

    Args:
        graph: What it is on.
        number: Its number on the pipes.
        told: What the twin has told of it.

    Attributes:
        name: Its full name, of a topic after remappings.
        node: Its node.
        kind: Its class.
        what: What it is: ``publisher``, ``subscription``, ``service`` or ``client``.
        of: The object of rclpy.
        is_heard: Whether anybody listens, or the service is there.

    Raises:
        UnusableTypeError: If its type cannot be used.
    """

    def __init__(self, graph: OfGraph, number: int, told: dict[str, Any]):
        self.graph, self.number, self.told = graph, number, told
        self.kind, self.what, self.name = class_of(told["type"]), told["what"], told["name"]
        check_fields(told["fields"])
        self.is_heard = False
        self.node = graph.node(told["node"])
        self.of = self.made()

    def made(self) -> Any:
        """Return the object of rclpy."""
        raise NotImplementedError

    def look(self) -> None:
        """Tell whether anybody listens, if that has changed."""
        is_heard = self.is_wanted()
        if is_heard != self.is_heard:
            self.is_heard = is_heard
            self.graph.pipe.write(HEARD, self.number, int(is_heard))

    def is_wanted(self) -> bool:
        """Return whether anybody listens, or the service is there."""
        return False

    def take(self) -> None:
        """Take what has come."""

    def send(self, number: int, data: bytes) -> None:
        """Send what the twin has sent."""


class Publisher(Endpoint):
    """Publishes the twin's messages."""

    def made(self) -> Any:
        """Return the object of rclpy."""
        publisher = self.node.create_publisher(self.kind, self.name, _quality(self.told))
        self.name = publisher.handle.get_topic_name()
        return publisher

    def is_wanted(self) -> bool:
        """Return whether anybody listens beside the twin."""
        own = len([*self.graph.own_subscriptions(self.name)])
        return bool(self.told["latched"]) or self.of.get_subscription_count() > own

    def send(self, number: int, data: bytes) -> None:
        """Publish a message."""
        for subscription in self.graph.own_subscriptions(self.name):
            subscription.expect(data)
        self.of.publish(data)


class Subscription(Endpoint):
    """Hears messages, but not those that the twin has published itself."""

    def made(self) -> Any:
        """Return the object of rclpy."""
        self._echoes: deque[tuple[float, bytes]] = deque()
        quality = _quality(self.told)
        subscription = self.node.create_subscription(self.kind, self.name, lambda data: None, quality, raw=True)
        self.name = subscription.handle.get_topic_name()
        return subscription

    def expect(self, data: bytes) -> None:
        """Expect a message that the twin publishes."""
        self._echoes.append((time.monotonic() + _LONGEST_ECHO, _padded(data)))

    def take(self) -> None:
        """Tell the twin what has come."""
        handle = self.of.handle
        for _ in range(_MOST_TAKEN):
            with handle:
                taken = handle.take_message(self.kind, True)
            if taken is None:
                return
            if not (self._echoes and self._is_echo(taken[0])):
                self.graph.pipe.write(MESSAGE, self.number, 0, taken[0])

    def _is_echo(self, data: bytes) -> bool:
        while self._echoes and self._echoes[0][0] < time.monotonic():
            self._echoes.popleft()
        data = _padded(data)
        for echo in tuple(self._echoes):
            if echo[1] == data:
                self._echoes.remove(echo)
                return True
        return False


class Service(Endpoint):
    """Answers requests with the twin's responses."""

    def made(self) -> Any:
        """Return the object of rclpy."""
        self._numbers = itertools.count(1)
        self._asked: dict[int, Any] = {}
        quality = _quality({"depth": _REQUESTS})
        return self.node.create_service(self.kind, self.name, lambda *_: None, qos_profile=quality)

    def take(self) -> None:
        """Tell the twin the next request."""
        from rclpy.serialization import serialize_message

        with self.of.handle:
            request, header = self.of.handle.service_take_request(self.kind.Request)
        if request is not None:
            number = next(self._numbers)
            self._asked[number] = header
            self.graph.pipe.write(REQUEST, self.number, number, serialize_message(request))

    def send(self, number: int, data: bytes) -> None:
        """Send a response."""
        from rclpy.serialization import deserialize_message

        self.of.send_response(deserialize_message(data, self.kind.Response), self._asked.pop(number))


class Client(Endpoint):
    """Asks a service of another program what the twin asks."""

    def made(self) -> Any:
        """Return the object of rclpy."""
        self._asked: dict[int, int] = {}
        return self.node.create_client(self.kind, self.name)

    def is_wanted(self) -> bool:
        """Return whether the service is there."""
        return bool(self.of.service_is_ready())

    def take(self) -> None:
        """Tell the twin the next response."""
        from rclpy.serialization import serialize_message

        with self.of.handle:
            header, response = self.of.handle.take_response(self.kind.Response)
        if header is None:
            return
        with self.graph.lock:
            number = self._asked.pop(header.request_id.sequence_number, None)
        if number is not None:
            self.graph.pipe.write(RESPONSE, self.number, number, serialize_message(response))

    def send(self, number: int, data: bytes) -> None:
        """Send a request."""
        from rclpy.serialization import deserialize_message

        request = deserialize_message(data, self.kind.Request)
        with self.graph.lock, self.of.handle:
            self._asked[self.of.handle.send_request(request)] = number


ENDPOINTS: dict[str, type[Endpoint]] = {
    "publisher": Publisher,
    "subscription": Subscription,
    "service": Service,
    "client": Client,
}


def _padded(data: bytes) -> bytes:
    """Return a message without its header and with the zeros to which a middleware fills it up."""
    return data[4:] + bytes(-len(data) % 4)


def _quality(told: dict[str, Any]) -> Any:
    """Return the quality of service: reliable by default, and kept for late joiners if latched."""
    from rclpy.duration import Duration
    from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy

    names = {"lifespan": "lifespan", "deadline": "deadline", "lease": "liveliness_lease_duration"}
    more: dict[str, Any] = {names[key]: Duration(seconds=told[key]) for key in names if told.get(key) is not None}
    if told.get("is_manual"):
        more["liveliness"] = LivelinessPolicy.MANUAL_BY_TOPIC
    return QoSProfile(
        history=HistoryPolicy.KEEP_ALL if told.get("keeps_all") else HistoryPolicy.KEEP_LAST,
        depth=told["depth"],
        durability=DurabilityPolicy.TRANSIENT_LOCAL if told.get("latched") else DurabilityPolicy.VOLATILE,
        reliability=ReliabilityPolicy.BEST_EFFORT if told.get("best_effort") else ReliabilityPolicy.RELIABLE,
        **more,
    )
