"""The ROS 2 graph over Zenoh, in the format of rmw_zenoh for Jazzy."""

import contextlib
import itertools
import logging
import threading
import time
from collections.abc import Callable
from typing import Any

from drake_twin.wires.log_once import LogOnce
from drake_twin.wires.rmw_zenoh_format import (
    NO_HASH,
    PUBLISHER,
    SUBSCRIPTION,
    Node,
    Qos,
    any_type_key,
    attachment,
    gid,
    graph_key,
    read_token,
    session_of,
    topic_key,
)
from drake_twin.wires.ros_names import domain_of_environment, is_name, ros_type
from drake_twin.wires.wire import LARGEST, Closable, Nothing, Reply, Sender, ServiceClient, WireEndpoint
from drake_twin.wires.zenoh_service import ZenohClient, ZenohServer
from drake_twin.wires.zenoh_session import ROUTER_PORT, open_session

_log = logging.getLogger(__name__)
_LONGEST_CLOSE = 1.0  # s that the caller waits for the session's end
_PERIOD = 0.02  # s between two looks at who listens
_MOST_TOKENS = 1_000_000  # of a look at the graph. Zenoh's own 256 stop the session for ever where more come before the
# first is taken: it keeps its lock while it waits for a place, and the look needs it.
_HEARTBEAT = 0.5  # s after which a late joiner notices a message that it has missed (rmw_publisher_data.cpp)


class ZenohWire:
    """A Zenoh session that stands on the graph as rmw_zenoh's nodes do.

    Args:
        domain: The ROS domain; ``ROS_DOMAIN_ID`` by default.
        host: The address to listen on as a router, where no router runs on this machine.
        port: The router's port.
        router: The address of a router to connect to in any case, ``HOST`` or ``HOST:PORT``.

    Attributes:
        domain: The ROS domain.
        place: Where it is open or connected to, in words.
        session_id: The session's id in the graph's tokens.

    Raises:
        InputError: If Zenoh is not installed, or the domain, the address or the port cannot be used.
    """

    def __init__(
        self,
        domain: int | None = None,
        host: str = "127.0.0.1",
        port: int = ROUTER_PORT,
        router: str | None = None,
    ):
        self.domain = domain_of_environment() if domain is None else domain
        opened = open_session(host, port, router)
        self._session = opened.session
        self.place = f"open on {opened.address}, as router"
        if opened.router is not None:
            self.place = f"open on {opened.address}, connected to the router at {opened.router}"
        self.session_id = str(self._session.zid())
        self._graph = _Graph(self._session, self.domain)
        self._senders: list[_Sender] = []
        self._clients: list[ZenohClient] = []
        self._is_closed = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="drake_twin listeners", daemon=True)
        self._thread.start()

    def advertise(self, topic: WireEndpoint, listened: Callable[[bool], None]) -> Sender:
        """Offer a topic; see `drake_twin.wires.wire.Wire`."""
        if not _has_name(topic):
            return Nothing()
        sender = _Sender(self._session, self._graph, topic, listened, self._senders.remove)
        self._senders.append(sender)
        return sender

    def listen(self, topic: WireEndpoint, heard: Callable[[bytes], None]) -> Closable:
        """Hear a topic; see `drake_twin.wires.wire.Wire`."""
        if not _has_name(topic):
            return Nothing()
        return _Listener(self._session, self._graph, topic, heard)

    def serve(self, service: WireEndpoint, answer: Callable[[bytes, Reply], None]) -> Closable:
        """Offer a service; see `drake_twin.wires.wire.Wire`."""
        if not _has_name(service):
            return Nothing()
        return ZenohServer(self._session, self._graph, service, answer)

    def client(self, service: WireEndpoint, changed: Callable[[], None]) -> ServiceClient:
        """Look for a service of another program; see `drake_twin.wires.wire.AskingWire`."""
        if not _has_name(service):
            return Nothing()
        client = ZenohClient(self._session, self._graph, service, changed, self._clients.remove)
        self._clients.append(client)
        return client

    def tokens(self, domain: int | str) -> list[str]:
        """Return the liveliness tokens of a domain; of all domains with ``*``."""
        from zenoh import handlers

        channel: Any = handlers.FifoChannel(_MOST_TOKENS)
        replies = self._session.liveliness().get(graph_key(domain), channel)
        return sorted(str(reply.ok.key_expr) for reply in replies if reply.ok is not None)

    def topics_beside(self, node: str) -> list[str]:
        """Return the topics of other sessions with a node; see `drake_twin.wires.other_twins`."""
        entities = [(session_of(token), read_token(token)) for token in self.tokens(self.domain)]
        sessions = {session for session, item in entities if item is not None and item.node == node}
        return sorted(
            item.name
            for session, item in entities
            if item is not None and item.kind == PUBLISHER and session in sessions
        )

    def close(self) -> None:
        """End the session: an open one keeps the process alive.

        A peer that has stopped to read makes Zenoh wait for it, and fail then; that is left to a thread.
        """
        self._is_closed.set()
        self._thread.join()
        closing = threading.Thread(target=self._close_session, name="drake_twin closing", daemon=True)
        closing.start()
        closing.join(_LONGEST_CLOSE)

    def _close_session(self) -> None:
        import zenoh

        with contextlib.suppress(zenoh.ZError):
            self._session.close()

    def _watch(self) -> None:
        """Look who listens and which services are there, in a thread of its own.

        Zenoh could call back instead. But to end a topic while it does so takes it 10 s, in which no thread of Python
        runs: it waits for the callback, which waits for Python.
        """
        while not self._is_closed.wait(_PERIOD):
            for sender in tuple(self._senders):
                sender.look()
            for client in tuple(self._clients):
                client.look()


def _has_name(endpoint: WireEndpoint) -> bool:
    """Tell whether an endpoint has a name that can be on the graph; log if not."""
    if is_name(endpoint.name) and is_name(endpoint.node):
        return True
    _log.warning("%s of %s is not on the graph: it is not a name of ROS", endpoint.name, endpoint.node)
    return False


class _Graph:
    """The liveliness tokens of a session; a node's lives as long as one of its endpoints."""

    def __init__(self, session: Any, domain: int):
        self.domain = domain
        self._session_id = str(session.zid())
        self._declare = session.liveliness().declare_token
        self._numbers = itertools.count()
        self._nodes: dict[str, tuple[Node, Any]] = {}
        self._users: dict[str, int] = {}
        self._of_all: dict[str, tuple[WireEndpoint, Qos]] = {}  # publishers that each node has, by their topics
        self._tokens_of_all: dict[tuple[str, str], Any] = {}  # by node and topic
        self._lock = threading.Lock()

    def add(self, kind: str, endpoint: WireEndpoint, qos: Qos) -> tuple[bytes, Callable[[], None]]:
        """Put an endpoint on the graph; return its gid, and a function that takes it off."""
        with self._lock:
            if is_new := endpoint.node not in self._nodes:
                namespace, _, name = endpoint.node.rpartition("/")
                node = Node(self.domain, self._session_id, next(self._numbers), name, namespace or "/")
                self._nodes[endpoint.node] = node, self._declare(node.token())
            self._users[endpoint.node] = self._users.get(endpoint.node, 0) + 1
            node, _ = self._nodes[endpoint.node]
            text = self._text(node, kind, endpoint, qos)
            token = self._declare(text)
            is_of_all = endpoint.of_all_nodes and kind == PUBLISHER
            if is_of_all:
                self._of_all[endpoint.name] = endpoint, qos
            if is_new or is_of_all:
                self._follow_nodes()
        return gid(text), lambda: self._remove(endpoint, token, is_of_all=is_of_all)

    def _text(self, node: Node, kind: str, endpoint: WireEndpoint, qos: Qos) -> str:
        type_hash = endpoint.hash or NO_HASH
        return node.endpoint_token(next(self._numbers), kind, endpoint.name, endpoint.type, type_hash, qos)

    def _follow_nodes(self) -> None:
        """Give each node the publishers that all have."""
        wanted = {
            (name, topic): (node, endpoint, qos)
            for name, (node, _) in self._nodes.items()
            for topic, (endpoint, qos) in self._of_all.items()
            if name != endpoint.node
        }
        for key in self._tokens_of_all.keys() - wanted.keys():
            self._tokens_of_all.pop(key).undeclare()
        for key in wanted.keys() - self._tokens_of_all.keys():
            node, endpoint, qos = wanted[key]
            self._tokens_of_all[key] = self._declare(self._text(node, PUBLISHER, endpoint, qos))

    def _remove(self, endpoint: WireEndpoint, token: Any, *, is_of_all: bool) -> None:
        token.undeclare()
        name = endpoint.node
        with self._lock:
            if is_of_all:
                self._of_all.pop(endpoint.name, None)
            self._users[name] -= 1
            if not self._users[name]:
                _, node_token = self._nodes.pop(name)
                del self._users[name]
                node_token.undeclare()
            if is_of_all or name not in self._nodes:
                self._follow_nodes()


class _Sender:
    """Sends the messages of a topic.

    Attributes:
        is_heard: Whether anybody listens; always true for a topic whose messages are kept for late joiners.
    """

    def __init__(
        self,
        session: Any,
        graph: _Graph,
        topic: WireEndpoint,
        listened: Callable[[bool], None],
        closed: "Callable[[_Sender], None]",
    ):
        import zenoh
        from zenoh import ext, handlers

        key = topic_key(graph.domain, topic.name, topic.type, topic.hash or NO_HASH)
        drop = zenoh.CongestionControl.DROP  # a peer that does not read must not stop the others
        self.is_heard = topic.latched
        self._listened = listened
        self._sequence = itertools.count(1)
        self._closed = closed
        self._listeners: Any = None
        self._lock = threading.Lock()
        if topic.latched:
            self._publisher: Any = ext.declare_advanced_publisher(
                session,
                key,
                congestion_control=drop,
                cache=ext.CacheConfig(topic.kept),
                publisher_detection=True,
                sample_miss_detection=ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=_HEARTBEAT),
            )
        else:
            self._publisher = session.declare_publisher(key, congestion_control=drop)
            self._listeners = self._publisher.declare_matching_listener(handlers.RingChannel(1))
        self._gid, self._leave = graph.add(PUBLISHER, topic, _quality(topic))

    def send(self, data: bytes, at: int) -> None:
        """Send a message; its source timestamp is the wall clock's, as rmw_zenoh's is."""
        self._publisher.put(data, attachment=attachment(next(self._sequence), time.time_ns(), self._gid))

    def close(self) -> None:
        """Take it off the graph."""
        self._closed(self)
        self._leave()
        with self._lock:
            if self._listeners is not None:
                self._listeners.undeclare()
                self._listeners = None
        self._publisher.undeclare()

    def look(self) -> None:
        """Look whether anybody listens, and tell if that has changed."""
        with self._lock:
            status = None if self._listeners is None else self._listeners.try_recv()
        if status is not None and status.matching != self.is_heard:
            self.is_heard = status.matching
            self._listened(self.is_heard)


def _quality(topic: WireEndpoint) -> Qos:
    deadline, lifespan, lease = (
        None if span is None else round(span * 1e9) for span in (topic.deadline, topic.lifespan, topic.lease)
    )
    depth = 0 if topic.keeps_all else topic.kept
    return Qos(topic.latched, depth, not topic.is_best_effort, deadline, lifespan, topic.is_manual, lease)


class _Listener:
    """Hears the messages of a topic, whatever their hash, so that a wrong one can be reported.

    Of a latched topic, it hears the last message that was sent before, too.
    """

    def __init__(self, session: Any, graph: _Graph, topic: WireEndpoint, heard: Callable[[bytes], None]):
        from zenoh import ext, handlers

        self._topic, self._heard = topic, heard
        self._expected = topic_key(graph.domain, topic.name, topic.type, "")
        self._tell = LogOnce(_log, topic.name)
        call = handlers.Callback(self._take, indirect=False)
        key = any_type_key(graph.domain, topic.name)
        if topic.latched:
            history = ext.HistoryConfig(max_samples=topic.kept, detect_late_publishers=True)
            self._subscriber: Any = ext.declare_advanced_subscriber(session, key, call, history=history)
        else:
            self._subscriber = session.declare_subscriber(key, call)
        _, self._leave = graph.add(SUBSCRIPTION, topic, _quality(topic))

    def close(self) -> None:
        """Take it off the graph."""
        self._leave()
        self._subscriber.undeclare()

    def _take(self, sample: Any) -> None:
        problem = self._problem(str(sample.key_expr), len(sample.payload))
        if problem is None:
            self._heard(sample.payload.to_bytes())
        else:
            self._tell(problem)

    def _problem(self, key: str, size: int) -> str | None:
        """Return why a message is not heard."""
        topic = self._topic
        if not key.startswith(self._expected):
            return f"a {_ros_type(key)} is ignored: the topic's type is {topic.type}"
        type_hash = key.removeprefix(self._expected)
        if topic.hash and type_hash not in (topic.hash, NO_HASH):
            return f"a message is ignored: its {topic.type} is another one, with the hash {type_hash}"
        if size > LARGEST:
            return f"a message of more than {LARGEST} bytes is ignored"
        return None


def _ros_type(key: str) -> str:
    """Return the ROS type in a key expression."""
    return ros_type(key.split("/")[-2])
