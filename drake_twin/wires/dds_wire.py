"""The ROS 2 graph over DDS: topics only, as rmw_cyclonedds_cpp and rmw_fastrtps_cpp speak."""

import logging
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from drake_twin.errors import InputError
from drake_twin.requirements import missing
from drake_twin.wires.dds_graph import DdsGraph
from drake_twin.wires.rmw_dds_format import (
    GRAPH_TOPIC,
    GRAPH_TYPE,
    PARTICIPANT_DATA,
    NodeEndpoints,
    configuration,
    endpoint_data,
    graph_message,
    sample_type,
    topic_name,
)
from drake_twin.wires.ros_names import domain_of_environment, is_name
from drake_twin.wires.wire import LARGEST, Closable, Reply, Sender, WireEndpoint

_log = logging.getLogger(__name__)
LOOPBACK = "127.0.0.1"
_PERIOD = 20_000_000  # ns between two looks at who listens
_MOST_SAMPLES = 100  # that are taken from a reader at once
_PATIENCE = 1  # ms for readers to make room for a message; then it is lost


class DdsWire:
    """A DDS participant with the endpoints and the graph of ROS 2 nodes.

    Args:
        domain: The ROS domain; ``ROS_DOMAIN_ID`` by default.
        host: The address of the network interface. On the loopback interface nothing is multicast.

    Attributes:
        domain: The ROS domain.
        place: Where it is open, in words.

    Raises:
        InputError: If CycloneDDS is not installed, or the domain or the address cannot be used.
    """

    def __init__(self, domain: int | None = None, host: str = LOOPBACK):
        try:
            from cyclonedds.core import DDSException, Policy, Qos, WaitSet
            from cyclonedds.domain import Domain, DomainParticipant
        except ImportError:
            raise missing("the ROS 2 graph over DDS needs", "cyclonedds") from None
        self.domain = domain_of_environment() if domain is None else domain
        is_local = host == LOOPBACK
        self.place = f"open on {host}, {'without' if is_local else 'with'} multicast"
        try:
            self._domain: Any = Domain(self.domain, configuration(host, multicast=not is_local))
            self._participant: Any = DomainParticipant(self.domain, Qos(Policy.Userdata(PARTICIPANT_DATA)))
        except DDSException as error:
            raise InputError(f"--ros dds: domain {self.domain} cannot be opened on {host}: {error}") from None
        self._waiting: Any = WaitSet(self._participant)
        self._lock = threading.RLock()  # of the endpoints
        self._senders: list[_Sender] = []
        self._listeners: list[_Listener] = []
        self._graph: Any = _writer(self._participant, GRAPH_TOPIC, GRAPH_TYPE, _qos(latched=True))
        self._graph_type = sample_type(GRAPH_TYPE)
        self._has_changed = True
        self._others: Any = None
        self._told_services = False
        self._is_closed = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="drake_twin dds", daemon=True)
        self._thread.start()

    def advertise(self, topic: WireEndpoint, listened: Callable[[bool], None]) -> Sender:
        """Offer a topic; see `drake_twin.wires.wire.Wire`."""
        if "/_action/" in topic.name or not _can_be(topic):  # actions need services
            return _Nothing()
        with self._lock:
            writer = _writer(self._participant, topic_name(topic.name), topic.type, _qos(topic.latched, topic.hash))
            sender = _Sender(self, topic, writer, listened)
            self._senders.append(sender)
            self._has_changed = True
        return sender

    def listen(self, topic: WireEndpoint, heard: Callable[[bytes], None]) -> Closable:
        """Hear a topic; see `drake_twin.wires.wire.Wire`."""
        if not _can_be(topic):
            return _Nothing()
        from cyclonedds.core import ReadCondition, SampleState
        from cyclonedds.sub import DataReader
        from cyclonedds.topic import Topic

        with self._lock:
            name = Topic(self._participant, topic_name(topic.name), sample_type(topic.type))
            reader = DataReader(self._participant, name, _qos(latched=False, type_hash=topic.hash))
            condition = ReadCondition(reader, SampleState.NotRead)
            listener = _Listener(self, topic, reader, condition, heard)
            self._listeners.append(listener)
            self._waiting.attach(condition)
            self._has_changed = True
        return listener

    def serve(self, service: WireEndpoint, answer: Callable[[bytes, Reply], None]) -> Closable:
        """Serve nothing: services over DDS differ from vendor to vendor."""
        if not self._told_services:
            self._told_services = True
            _log.warning("services and actions are not offered over DDS: --ros zenoh offers them")
        return _Nothing()

    def begin_discovery(self) -> None:
        """Begin to collect what `topics_beside` returns, which takes others some time to tell."""
        if self._others is None:
            self._others = DdsGraph(self._participant)

    def topics_beside(self, node: str) -> list[str]:
        """Return the topics of other participants with a node; see `drake_twin.wires.other_twins`."""
        self.begin_discovery()
        others, self._others = self._others, None
        found: list[str] = others.topics_beside(node)
        return found

    def close(self) -> None:
        """End the participant."""
        self._is_closed.set()
        self._thread.join()
        for sender in tuple(self._senders):
            sender.close()
        for listener in tuple(self._listeners):
            listener.close()
        self._graph = self._others = self._waiting = self._participant = self._domain = None

    def forget(self, endpoint: "_Sender | _Listener") -> None:
        """Forget a closed endpoint."""
        with self._lock:
            if isinstance(endpoint, _Listener):
                self._waiting.detach(endpoint.condition)
                self._listeners.remove(endpoint)
            else:
                self._senders.remove(endpoint)
            self._has_changed = True

    @property
    def lock(self) -> Any:
        """The lock that keeps an endpoint from being closed while it is used."""
        return self._lock

    def _watch(self) -> None:
        """Take what has come, look who listens, and tell the graph.

        DDS could call back instead; but a callback that waits for Python while Python ends its endpoint never ends.
        """
        while not self._is_closed.is_set():
            self._waiting.wait(_PERIOD)
            with self._lock:
                for listener in tuple(self._listeners):
                    listener.take()
                for sender in tuple(self._senders):
                    sender.look()
                if self._has_changed:
                    self._has_changed = False
                    self._tell_graph()

    def _tell_graph(self) -> None:
        nodes: dict[str, NodeEndpoints] = {}
        for sender in self._senders:
            known = nodes.get(sender.topic.node, NodeEndpoints())
            nodes[sender.topic.node] = NodeEndpoints(known.readers, (*known.writers, sender.gid))
        for listener in self._listeners:
            known = nodes.get(listener.topic.node, NodeEndpoints())
            nodes[listener.topic.node] = NodeEndpoints((*known.readers, listener.gid), known.writers)
        self._graph.write(self._graph_type(graph_message(self._participant.guid.bytes, nodes)))


def _can_be(endpoint: WireEndpoint) -> bool:
    """Tell whether a topic can be on the graph; log if not."""
    if not is_name(endpoint.name) or not is_name(endpoint.node):
        _log.warning("%s of %s is not on the graph: it is not a name of ROS", endpoint.name, endpoint.node)
        return False
    try:
        sample_type(endpoint.type)
    except ValueError as error:
        _log.warning("%s is not on the graph: %s", endpoint.name, error)
        return False
    return True


def _qos(latched: bool, type_hash: str = "") -> Any:
    """Return the quality of service of a topic as ROS has it: reliable, and kept for late joiners if latched."""
    from cyclonedds.core import Policy, Qos
    from cyclonedds.util import duration

    return Qos(
        Policy.Reliability.Reliable(max_blocking_time=duration(milliseconds=_PATIENCE)),
        Policy.Durability.TransientLocal if latched else Policy.Durability.Volatile,
        Policy.History.KeepLast(1 if latched else 10),
        Policy.DataRepresentation(use_cdrv0_representation=True),
        Policy.WriterDataLifecycle(autodispose=False),
        Policy.Userdata(endpoint_data(type_hash)),
    )


def _writer(participant: Any, name: str, kind: str, qos: Any) -> Any:
    from cyclonedds.pub import DataWriter
    from cyclonedds.topic import Topic

    return DataWriter(participant, Topic(participant, name, sample_type(kind)), qos)


class _Nothing:
    """Stands for what is not on the graph."""

    is_heard = False

    def send(self, data: bytes, at: int) -> None:
        """Send nothing."""

    def close(self) -> None:
        """Nothing is to be ended."""


class _Sender:
    """Sends the messages of a topic.

    Attributes:
        topic: The topic.
        gid: The 16 bytes of the writer's GUID.
        is_heard: Whether anybody listens; always true for a topic whose messages are kept for late joiners.
    """

    def __init__(self, wire: DdsWire, topic: WireEndpoint, writer: Any, listened: Callable[[bool], None]):
        self.topic, self.gid = topic, writer.guid.bytes
        self.is_heard = topic.latched
        self._wire, self._writer, self._listened = wire, writer, listened
        self._kind = sample_type(topic.type)

    def send(self, data: bytes, at: int) -> None:
        from cyclonedds.core import DDSException

        with self._wire.lock, suppress(DDSException):  # readers that have no room lose it
            if self._writer is not None:
                self._writer.write(self._kind(data))

    def close(self) -> None:
        """Take it off the graph."""
        with self._wire.lock:
            if self._writer is not None:
                self._writer = None
                self._wire.forget(self)

    def look(self) -> None:
        """Look whether anybody listens, and tell if that has changed."""
        if self.topic.latched:
            return
        is_heard = bool(self._writer.get_matched_subscriptions())
        if is_heard != self.is_heard:
            self.is_heard = is_heard
            self._listened(is_heard)


class _Listener:
    """Hears the messages of a topic.

    Attributes:
        topic: The topic.
        gid: The 16 bytes of the reader's GUID.
        condition: The condition that there are messages.
    """

    def __init__(self, wire: DdsWire, topic: WireEndpoint, reader: Any, condition: Any, heard: Callable[[bytes], None]):
        self.topic, self.gid, self.condition = topic, reader.guid.bytes, condition
        self._wire, self._reader, self._heard = wire, reader, heard
        self._has_told = False

    def take(self) -> None:
        """Hand on what has come."""
        for sample in self._reader.take(_MOST_SAMPLES):
            data = getattr(sample, "data", b"")  # one without is about a writer that has gone
            if len(data) > LARGEST:
                if not self._has_told:
                    self._has_told = True
                    _log.warning("%s: a message of more than %s bytes is ignored", self.topic.name, LARGEST)
            elif data:
                self._heard(data)

    def close(self) -> None:
        """Take it off the graph."""
        with self._wire.lock:
            if self._reader is not None:
                self._wire.forget(self)
                self.condition = self._reader = None
