"""A program of its own on the graph of a running twin: ``Client``.

It speaks Zenoh as ROS 2's rmw_zenoh does, and needs neither ROS nor Drake::

    with Client() as client:
        commands = client.publisher("/robot_1/forward_velocity_controller/commands")
        commands.publish({"data": [2.0, 2.0, 2.0, 2.0]})
"""

import logging
import os
import threading
from collections.abc import Callable
from difflib import get_close_matches
from types import TracebackType
from typing import Any, Self

from drake_twin.errors import InputError
from drake_twin.messages.interface_types import deserialize, knows, make, serialize, type_hash, type_names
from drake_twin.wires.rmw_zenoh_format import NODE, PUBLISHER, SERVICE, SUBSCRIPTION, GraphEntity
from drake_twin.wires.wire import Closable, WireEndpoint
from drake_twin.wires.zenoh_client import ZenohClient
from drake_twin.wires.zenoh_session import ROUTER_PORT

_log = logging.getLogger(__name__)
START = "start a twin with: python -m drake_twin.run … --ros zenoh"
_LONGEST_CALL = 600.0  # s
_DEPTH = 5  # messages of a latched topic that come at once, as those of `ros2 topic echo`


class Client:
    """A node on the graph of a running twin.

    Args:
        router: The address of the twin, or of the router that it is connected to: ``HOST`` or ``HOST:PORT``.
        domain: The ROS domain; ``ROS_DOMAIN_ID`` by default.
        node: The node's full name.

    Raises:
        InputError: If Zenoh is not installed, the domain is invalid, or nothing answers at the address.
    """

    def __init__(self, router: str = f"127.0.0.1:{ROUTER_PORT}", domain: int | None = None, node: str | None = None):
        self.node = node or f"/_drake_twin_{os.getpid()}"  # a leading underscore hides it, as those of the ros2 tools
        try:
            self._wire = ZenohClient(router, domain)
        except InputError as error:
            raise InputError(f"{error.message}; {START}" if "answers" in error.message else error.message) from None
        self.domain = self._wire.domain

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Leave the graph: an open session keeps a process alive."""
        self._wire.close()

    def entities(self) -> list[GraphEntity]:
        """Return the nodes, publishers, subscriptions and services on the graph, without this client's.

        Raises:
            InputError: If the graph is empty.
        """
        found = [entity for entity in self._wire.entities() if entity.node != self.node]
        if not found:
            text = f"no twin and no node is on the ROS 2 graph in domain {self.domain}"
            others = ", ".join(str(number) for number in self._wire.domains() if number != self.domain)
            raise InputError(f"{text}; {f'there are in domain {others}: set ROS_DOMAIN_ID' if others else START}")
        return found

    def nodes(self) -> list[str]:
        """Return the full names of the nodes, sorted."""
        return sorted({entity.node for entity in self.entities() if entity.kind == NODE})

    def topics(self) -> dict[str, str]:
        """Return the topics that are published or subscribed to, sorted, with their types."""
        return self._types(PUBLISHER, SUBSCRIPTION)

    def services(self) -> dict[str, str]:
        """Return the services, sorted, with their types."""
        return self._types(SERVICE)

    def subscribe(
        self, topic: str, heard: Callable[[Any], None], kind: str | None = None, *, is_raw: bool = False
    ) -> Closable:
        """Subscribe to a topic; of a latched one, the last messages come at once.

        Args:
            topic: Its full name.
            heard: Is called with each message, in another thread.
            kind: The message type; by default the one that the graph says.
            is_raw: Whether `heard` is given each message's CDR bytes.

        Returns:
            The subscription; close it to end it.

        Raises:
            InputError: If the topic is not on the graph, or its type is unknown or another one.
        """
        topic = full_name(topic)
        entities = [item for item in self.entities() if item.kind in (PUBLISHER, SUBSCRIPTION)]
        kind = _checked_type("topic", topic, kind, dict(sorted((item.name, item.type) for item in entities)))
        latched = any(item.latched for item in entities if item.name == topic and item.kind == PUBLISHER)
        endpoint = self._endpoint(topic, kind, latched)
        return self._wire.listen(endpoint, heard if is_raw else _Decoder(endpoint, heard).take)

    def publisher(self, topic: str, kind: str | None = None, *, must_exist: bool = True) -> "Publisher":
        """Make a publisher.

        Args:
            topic: The topic's full name.
            kind: The message type; by default the one that the graph says.
            must_exist: Whether a topic that nobody subscribes to is refused.

        Raises:
            InputError: If nobody subscribes to the topic, or its type is unknown or another one.
        """
        topic = full_name(topic)
        known = self._types(SUBSCRIPTION) if must_exist else self.topics()
        if kind is not None and not must_exist:
            known.setdefault(topic, _full_type(kind, "msg"))
        return Publisher(self._wire, self._endpoint(topic, _checked_type("subscribed topic", topic, kind, known)))

    def service_type(self, service: str, kind: str | None = None) -> str:
        """Return the type of a service.

        Raises:
            InputError: If the service is not on the graph, or `kind` is given and another one, or unknown.
        """
        service = full_name(service)
        return _checked_type("service", service, kind, self.services())

    def call(self, service: str, request: Any = None, kind: str | None = None) -> Any:
        """Call a service and wait for its response, at most ten minutes.

        Args:
            service: Its full name.
            request: The request's fields; those that are missing have ROS's default values.
            kind: The service type; by default the one that the graph says.

        Returns:
            The response message.

        Raises:
            InputError: If the service is not on the graph, or the request does not fit its type.
            RunError: If the service does not answer.
        """
        service = full_name(service)
        kind = self.service_type(service, kind)
        data = serialize(made(service, f"{kind}_Request", request or {}))
        return deserialize(f"{kind}_Response", self._wire.call(self._endpoint(service, kind), data, _LONGEST_CALL))

    def _types(self, *kinds: str) -> dict[str, str]:
        return dict(sorted((item.name, item.type) for item in self.entities() if item.kind in kinds))

    def _endpoint(self, name: str, kind: str, latched: bool = False) -> WireEndpoint:
        return WireEndpoint(name, kind, type_hash(kind), self.node, latched, depth=_DEPTH if latched else 0)


class _Decoder:
    """Turns the bytes of a topic into messages; logs once if they are not of its type."""

    def __init__(self, endpoint: WireEndpoint, heard: Callable[[Any], None]):
        self._endpoint, self._heard = endpoint, heard
        self._is_reported = False

    def take(self, data: bytes) -> None:
        try:
            message = deserialize(self._endpoint.type, data)
        except ValueError as error:
            if not self._is_reported:
                _log.warning("%s: a message is ignored: %s", self._endpoint.name, error)
            self._is_reported = True
            return
        self._heard(message)


class Publisher:
    """Publishes the messages of a topic.

    Attributes:
        topic: The topic's full name.
        type: Its message type.
    """

    def __init__(self, wire: ZenohClient, endpoint: WireEndpoint):
        self.topic, self.type = endpoint.name, endpoint.type
        self._is_heard = threading.Event()
        self._sender = wire.advertise(endpoint, lambda is_heard: self._is_heard.set() if is_heard else None)

    def wait_for_subscriber(self, timeout: float | None = None) -> bool:
        """Wait until there is a subscriber, so that no message is lost.

        Args:
            timeout: The longest wait (s); without end by default.

        Returns:
            Whether there is one.
        """
        return self._is_heard.wait(timeout)

    def publish(self, data: Any) -> None:
        """Publish a message.

        Args:
            data: The message, or its fields; those that are missing have ROS's default values.

        Raises:
            InputError: If the data does not fit the topic's type.
        """
        self._sender.send(serialize(made(self.topic, self.type, data)), 0)

    def close(self) -> None:
        """End the publisher."""
        self._sender.close()


def full_name(name: str) -> str:
    """Return a topic's, service's or node's name with a leading slash."""
    return f"/{name.strip('/')}"


def made(name: str, kind: str, data: Any) -> Any:
    """Make a message for a topic or service.

    Raises:
        InputError: If the data does not fit the type; the text names the topic.
    """
    try:
        return make(kind, data)
    except ValueError as error:
        raise InputError(f"{name}: {error}") from None


def _full_type(kind: str, folder: str) -> str:
    """Return ``std_msgs/msg/String`` for ``std_msgs/String``, which the ros2 tools take, too."""
    return kind.replace("/", f"/{folder}/") if kind.count("/") == 1 else kind


def _checked_type(what: str, name: str, kind: str | None, known: dict[str, str]) -> str:
    """Return the type of a topic or service.

    Raises:
        InputError: If it is not known, or `kind` is another one.
    """
    if name not in known:
        raise InputError(f"unknown {what} {name!r}", value=name, valid=known)
    found = known[name]
    part = "_Request" if what == "service" else ""
    wanted = _full_type(kind or found, "srv" if part else "msg")
    if not knows(f"{wanted}{part}"):
        close = get_close_matches(wanted, type_names())
        raise InputError(f"the type {wanted} of {name} is not known here", valid=close or None)
    if wanted != found:
        raise InputError(f"the {what} {name} has the type {found}, not {wanted}")
    return found
