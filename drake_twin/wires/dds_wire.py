"""The ROS 2 graph over DDS: topics as all of ROS 2's middlewares speak them, services as rmw_cyclonedds_cpp does."""

import itertools
import logging
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext, suppress
from typing import Any, TypeVar

from drake_twin.errors import InputError
from drake_twin.messages.interface_types import type_hash
from drake_twin.requirements import missing
from drake_twin.wires.dds_discovery import Discovery, End
from drake_twin.wires.dds_endpoints import MOST_SAMPLES, matched, quality, reader, writer
from drake_twin.wires.dds_service import DdsClient, DdsServer
from drake_twin.wires.loopback_sockets import loopback_only
from drake_twin.wires.rmw_dds_format import (
    GRAPH_TOPIC,
    GRAPH_TYPE,
    PARTICIPANT_DATA,
    NodeEndpoints,
    configuration,
    endpoint_data,
    graph_message,
    sample_type,
    service_id,
    topic_name,
)
from drake_twin.wires.ros_names import domain_of_environment, is_name
from drake_twin.wires.wire import Closable, Nothing, Reply, Sender, ServiceClient, WireEndpoint

_log = logging.getLogger(__name__)
LOOPBACK = "127.0.0.1"
_Reading = TypeVar("_Reading", bound="_Listener | DdsServer | DdsClient")
_PERIOD = 0.02  # s between two looks at who listens
_DISCOVERY = 1.0  # s in which participants find one another


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
        held: AbstractContextManager[list[int]] = loopback_only() if is_local else nullcontext([])
        try:
            with held as open_ports:
                self._domain: Any = Domain(self.domain, configuration(host, multicast=not is_local))
                self._participant: Any = DomainParticipant(self.domain, Qos(Policy.Userdata(PARTICIPANT_DATA)))
        except DDSException as error:
            raise InputError(f"--ros dds: domain {self.domain} cannot be opened on {host}: {error}") from None
        if open_ports:
            what = "this system lets it receive from all interfaces: keep UDP ports %s behind a firewall"
            _log.warning("DDS: %s", what % ", ".join(map(str, open_ports)))
        self._waiting: Any = WaitSet(self._participant)
        self._lock = threading.RLock()  # of the endpoints
        self._senders: list[_Sender] = []
        self._readings: list[_Listener | DdsServer | DdsClient] = []  # that of which something came last comes first
        self._services = itertools.count(1)
        graph_data = endpoint_data(type_hash(GRAPH_TYPE))
        self._graph: Any = writer(
            self._participant, GRAPH_TOPIC, GRAPH_TYPE, quality(graph_data, latched=True, depth=1)
        )
        self._graph_type = sample_type(GRAPH_TYPE)
        self._has_changed, self._has_found = True, False
        self._discovery: Any = Discovery(self._participant)
        for condition in self._discovery.conditions:
            self._waiting.attach(condition)
        self._discovered = time.monotonic() + _DISCOVERY
        self._is_closed = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="drake_twin dds", daemon=True)
        self._thread.start()

    def advertise(self, topic: WireEndpoint, listened: Callable[[bool], None]) -> Sender:
        """Offer a topic; see `drake_twin.wires.wire.Wire`."""
        if not _can_be(topic, topic.type):
            return Nothing()
        with self._lock:
            qos = _quality(topic)
            sender = _Sender(self, topic, writer(self._participant, topic_name(topic.name), topic.type, qos), listened)
            self._senders.append(sender)
            self._has_changed = True
        return sender

    def listen(self, topic: WireEndpoint, heard: Callable[[bytes], None]) -> Closable:
        """Hear a topic; see `drake_twin.wires.wire.Wire`."""
        if not _can_be(topic, topic.type):
            return Nothing()
        with self._lock:
            made = reader(self._participant, topic_name(topic.name), topic.type, _quality(topic))
            return self._follow(_Listener(self, topic, *made, heard))

    def serve(self, service: WireEndpoint, answer: Callable[[bytes, Reply], None]) -> Closable:
        """Offer a service; see `drake_twin.wires.wire.Wire`."""
        if not _can_be(service, f"{service.type}_Request", f"{service.type}_Response"):
            return Nothing()
        with self._lock:
            name = service_id(self._participant.guid.bytes, next(self._services))
            return self._follow(DdsServer(self, self._participant, service, name, answer))

    def topics_beside(self, node: str) -> list[str]:
        """Return the topics of other participants with a node; see `drake_twin.wires.other_twins`."""
        self._is_closed.wait(max(0.0, self._discovered - time.monotonic()))  # they take some time to tell
        with self._lock:
            found: list[str] = self._discovery.topics_beside(node)
        return found

    def client(self, service: WireEndpoint, changed: Callable[[], None]) -> ServiceClient:
        """Look for a service of another program; see `drake_twin.wires.wire.AskingWire`."""
        if not _can_be(service, f"{service.type}_Request", f"{service.type}_Response"):
            return Nothing()
        with self._lock:
            name = service_id(self._participant.guid.bytes, next(self._services))
            return self._follow(DdsClient(self, self._participant, service, name, changed))

    def close(self) -> None:
        """End the participant."""
        self._is_closed.set()
        self._thread.join()
        for sender in tuple(self._senders):
            sender.close()
        for reading in tuple(self._readings):
            reading.close()
        self._graph = self._waiting = self._discovery = self._participant = self._domain = None

    def forget(self, endpoint: "_Sender | _Listener | DdsServer | DdsClient") -> None:
        """Forget a closed endpoint."""
        with self._lock:
            if isinstance(endpoint, _Sender):
                self._senders.remove(endpoint)
            else:
                self._waiting.detach(endpoint.condition)
                self._readings.remove(endpoint)
            self._has_changed = True

    @property
    def lock(self) -> Any:
        """The lock that keeps an endpoint from being closed while it is used."""
        return self._lock

    def _follow(self, reading: _Reading) -> _Reading:
        self._readings.append(reading)
        self._waiting.attach(reading.condition)
        self._has_changed = True
        return reading

    def _watch(self) -> None:
        """Take what has come, look who listens, and tell the graph.

        DDS could call back instead; but a callback that waits for Python while Python ends its endpoint never ends.
        """
        next_look = 0.0
        while not self._is_closed.is_set():
            count = self._waiting.wait(round(_PERIOD * 1e9))
            with self._lock:
                self._take(count)
                if (now := time.monotonic()) < next_look:
                    continue
                next_look = now + _PERIOD
                for sender in tuple(self._senders):
                    sender.look()
                for reading in tuple(self._readings):
                    if not isinstance(reading, _Listener):
                        reading.look()
                if self._has_changed or self._has_found:
                    ends = [end for item in (*self._senders, *self._readings) for end in item.ends]
                    self._discovery.tell(ends)
                    self._has_found = False
                if self._has_changed:
                    self._has_changed = False
                    self._tell_graph(ends)

    def _take(self, count: int) -> None:
        """Take what has come for so many readers: a look at each of a thousand would take milliseconds."""
        if count and (found := self._discovery.take()):
            self._has_found = True
            count -= found  # which is below zero if more has come since
        for index, reading in enumerate(tuple(self._readings)):
            if count <= 0:
                return
            if reading.take():
                self._readings.insert(0, self._readings.pop(index))
                count -= 1

    def _tell_graph(self, ends: Sequence[End]) -> None:
        nodes: dict[str, tuple[list[bytes], list[bytes]]] = {}
        for end in ends:
            nodes.setdefault(end.of.node, ([], []))[0 if end.is_reader else 1].append(end.guid)
        of_all = [end.guid for end in ends if end.of.of_all_nodes]
        entities = {
            name: NodeEndpoints(tuple(readers), tuple(dict.fromkeys((*writers, *of_all))))
            for name, (readers, writers) in nodes.items()
        }
        self._graph.write(self._graph_type(graph_message(self._participant.guid.bytes, entities)))


def _quality(topic: WireEndpoint) -> Any:
    return quality(
        endpoint_data(topic.hash),
        latched=topic.latched,
        depth=None if topic.keeps_all else topic.kept,
        is_best_effort=topic.is_best_effort,
        lifespan=topic.lifespan,
        deadline=topic.deadline,
        is_manual=topic.is_manual,
        lease=topic.lease,
    )


def _can_be(endpoint: WireEndpoint, *types: str) -> bool:
    """Tell whether a topic or service can be on the graph; log if not."""
    if not is_name(endpoint.name) or not is_name(endpoint.node):
        _log.warning("%s of %s is not on the graph: it is not a name of ROS", endpoint.name, endpoint.node)
        return False
    try:
        for kind in types:
            sample_type(kind)
    except ValueError as error:
        _log.warning("%s is not on the graph: %s", endpoint.name, error)
        return False
    return True


class _Sender:
    """Sends the messages of a topic.

    Attributes:
        topic: The topic.
        ends: Its writer.
        is_heard: Whether anybody listens; always true for a topic whose messages are kept for late joiners.
    """

    def __init__(self, wire: DdsWire, topic: WireEndpoint, writer: Any, listened: Callable[[bool], None]):
        self.topic = topic
        self.ends = (End(topic, topic_name(topic.name), topic.type, writer.guid.bytes, is_reader=False),)
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
        is_heard = bool(matched(self._writer.get_matched_subscriptions))
        if is_heard != self.is_heard:
            self.is_heard = is_heard
            self._listened(is_heard)


class _Listener:
    """Hears the messages of a topic.

    Attributes:
        topic: The topic.
        ends: Its reader.
        condition: The condition that there are messages.
    """

    def __init__(self, wire: DdsWire, topic: WireEndpoint, reader: Any, condition: Any, heard: Callable[[bytes], None]):
        self.topic, self.condition = topic, condition
        self.ends = (End(topic, topic_name(topic.name), topic.type, reader.guid.bytes, is_reader=True),)
        self._wire, self._reader, self._heard = wire, reader, heard
        self._has_told = False

    def take(self) -> bool:
        """Hand on what has come; return whether anything has."""
        samples = self._reader.take(MOST_SAMPLES)
        for sample in samples:
            data = getattr(sample, "data", b"")  # one without is about a writer that has gone
            if len(data) > self.topic.largest:
                if not self._has_told:
                    self._has_told = True
                    _log.warning("%s: a message of more than %s bytes is ignored", self.topic.name, self.topic.largest)
            elif data:
                self._heard(data)
        return bool(samples)

    def close(self) -> None:
        """Take it off the graph."""
        with self._wire.lock:
            if self._reader is not None:
                self._wire.forget(self)
                self.condition = self._reader = None
