"""Servers and clients of services over DDS, as rmw_cyclonedds_cpp has them.

A request comes from a writer and its response goes to a reader, which are the same client's if their user data says so.
A response that is written before the client's reader is known here would be lost, so it waits for that.
"""

import itertools
import logging
import time
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import Any, Protocol

from drake_twin.dataclass import dataclass
from drake_twin.messages.interface_types import type_hash
from drake_twin.wires.dds_discovery import End
from drake_twin.wires.dds_endpoints import MOST_SAMPLES, matched, quality, reader, writer
from drake_twin.wires.log_once import LogOnce
from drake_twin.wires.rmw_dds_format import (
    endpoint_data,
    read_endpoint_data,
    request_topic,
    response_topic,
    sample_type,
    with_header,
    without_header,
)
from drake_twin.wires.wire import LARGEST, Reply, WireEndpoint

_log = logging.getLogger(__name__)
_DEPTH = 1000  # requests that wait, as rmw_qos_profile_parameters has it: those of many clients come at once
_PATIENCE = 10.0  # s of wall time for a client's reader to be found, and to make room; then a response is lost
_OTHERS = "and other middlewares write requests otherwise: set RMW_IMPLEMENTATION=rmw_cyclonedds_cpp"
_MOST_CLIENTS = 1000  # that are remembered
_CLIENT, _SERVER = "clientid", "serviceid"  # in the user data


class ServingWire(Protocol):
    """What a server needs of its wire."""

    @property
    def lock(self) -> Any:
        """The lock that keeps an endpoint from being closed while it is used."""

    def forget(self, endpoint: Any) -> None:
        """Forget a closed endpoint."""


@dataclass(frozen=True)
class _Late:
    """A response that cannot be written yet."""

    deadline: float
    writer: int
    client: str
    data: bytes


class _ServiceEnds:
    """The reader and the writer of a service's server or client, whose user data have one id.

    Args:
        wire: The wire.
        participant: The participant.
        service: The service.
        key: What the id is called.
        name: The id.

    Attributes:
        topic: The service.
        ends: The reader and the writer.
        condition: The condition that something has come.
    """

    def __init__(self, wire: ServingWire, participant: Any, service: WireEndpoint, key: str, name: str):
        self.topic, self._wire = service, wire
        request = request_topic(service.name), f"{service.type}_Request"
        response = response_topic(service.name), f"{service.type}_Response"
        heard, said = (request, response) if key == _SERVER else (response, request)

        def qualities(kind: str) -> Any:
            return quality(endpoint_data(type_hash(kind), **{key: name}), depth=_DEPTH)

        self._reader, self.condition = reader(participant, *heard, qualities(heard[1]), has_header=True)
        self._writer = writer(participant, *said, qualities(said[1]), has_header=True)
        self._kind = sample_type(said[1], has_header=True)
        self.ends = (
            End(service, *heard, self._reader.guid.bytes, is_reader=True),
            End(service, *said, self._writer.guid.bytes, is_reader=False),
        )

    def close(self) -> None:
        """Take it off the graph."""
        with self._wire.lock:
            if self._reader is not None:
                self._wire.forget(self)
                self.condition = self._reader = self._writer = None


class DdsServer(_ServiceEnds):
    """Answers the requests of a service.

    Args:
        wire: The wire.
        participant: The participant.
        service: The service.
        name: What tells clients that its endpoints are one service's.
        answer: As in `drake_twin.wires.wire.Wire.serve`.
    """

    def __init__(
        self,
        wire: ServingWire,
        participant: Any,
        service: WireEndpoint,
        name: str,
        answer: Callable[[bytes, Reply], None],
    ):
        super().__init__(wire, participant, service, _SERVER, name)
        self._answer = answer
        self._clients: dict[int, str] = {}  # request's writer → the client's id
        self._matched: dict[str, int] = {}  # client's id → response's reader
        self._late: list[_Late] = []
        self._tell = LogOnce(_log, service.name)

    def take(self) -> bool:
        """Hand on the requests that have come; return whether anything has."""
        samples = self._reader.take(MOST_SAMPLES)
        for sample in samples:
            if data := getattr(sample, "data", b""):  # one without is about a client that has gone
                self._take(data, sample.sample_info.publication_handle)
        return bool(samples)

    def look(self) -> None:
        """Write the responses whose clients are known by now."""
        late, self._late = self._late, []
        for item in late:
            self._send(item)

    def _take(self, data: bytes, writer: int) -> None:
        client = self._client(writer)
        if not client:
            self._tell(f"a request is ignored: its client is not of rmw_cyclonedds_cpp, {_OTHERS}")
            return
        if len(data) > LARGEST:
            self._tell(f"a request of more than {LARGEST} bytes is ignored")
            return
        try:
            source, number, request = without_header(data)
        except ValueError as error:
            self._tell(f"a request is ignored: {error}")
            return
        self._answer(request, partial(self._reply, writer, client, source, number))

    def _reply(self, writer: int, client: str, source: int, number: int, data: bytes) -> None:
        """Send a response, in any thread."""
        with self._wire.lock:
            if self._writer is not None:
                deadline = time.monotonic() + _PATIENCE
                self._send(_Late(deadline, writer, client, with_header(source, number, data)))

    def _send(self, response: _Late) -> None:
        """Write a response, or keep it for later."""
        from cyclonedds.core import DDSException

        if self._has_reader(response.client):
            with suppress(DDSException):  # it has no room
                self._writer.write(self._kind(response.data))
                return
        if self._reader.get_matched_publication_data(response.writer) is None:
            return  # the client has gone
        if time.monotonic() < response.deadline:
            self._late.append(response)
        else:
            self._tell("a response is lost: its client does not read")

    def _client(self, writer: int) -> str:
        """Return the id of a request's client; empty if it says none."""
        if writer not in self._clients:
            if len(self._clients) >= _MOST_CLIENTS:
                self._clients.clear()
            self._clients[writer] = _value(self._reader.get_matched_publication_data(writer), _CLIENT)
        return self._clients[writer]

    def _has_reader(self, client: str) -> bool:
        """Return whether a client's reader is known."""
        handles = matched(self._writer.get_matched_subscriptions)
        if self._matched.get(client) not in handles:
            data = self._writer.get_matched_subscription_data
            self._matched = {_value(data(handle), _CLIENT): handle for handle in handles}
        return client in self._matched


class DdsClient(_ServiceEnds):
    """Asks a service of another program.

    Args:
        wire: The wire.
        participant: The participant.
        service: The service.
        name: What tells servers that its endpoints are one client's.
        changed: Is called when the service comes and goes.

    Attributes:
        is_there: Whether the service is there.
    """

    def __init__(
        self,
        wire: ServingWire,
        participant: Any,
        service: WireEndpoint,
        name: str,
        changed: Callable[[], None],
    ):
        super().__init__(wire, participant, service, _CLIENT, name)
        self.is_there, self._changed = False, changed
        self._own = self._writer.get_instance_handle() % (1 << 64)
        self._numbers = itertools.count(1)
        self._asked: dict[int, Reply] = {}
        self._servers: tuple[list[int], list[int]] = [], []

    def ask(self, request: bytes, answered: Reply) -> None:
        """Send a request."""
        from cyclonedds.core import DDSException

        with self._wire.lock:
            if self._writer is None:
                return
            number = next(self._numbers)
            self._asked[number] = answered
            try:
                self._writer.write(self._kind(with_header(self._own, number, request)))
            except DDSException as error:
                del self._asked[number]
                _log.warning("%s: a request is lost: %s", self.topic.name, error)

    def take(self) -> bool:
        """Hand on the responses that have come; return whether anything has."""
        samples = self._reader.take(MOST_SAMPLES)
        for sample in samples:
            data = getattr(sample, "data", b"")
            with suppress(ValueError):  # it is not for this client
                client, number, response = without_header(data)
                if client == self._own and (answered := self._asked.pop(number, None)) is not None:
                    answered(response)
        return bool(samples)

    def look(self) -> None:
        """Look whether the service is there: a server of which both endpoints are known."""
        servers = matched(self._writer.get_matched_subscriptions), matched(self._reader.get_matched_publications)
        if servers == self._servers:
            return
        self._servers = servers
        readers = {_value(self._writer.get_matched_subscription_data(item), _SERVER) for item in servers[0]}
        writers = {_value(self._reader.get_matched_publication_data(item), _SERVER) for item in servers[1]}
        is_there = bool(readers & writers - {""})
        if is_there != self.is_there:
            self.is_there = is_there
            if not is_there:
                self._asked.clear()  # nobody answers them
            self._changed()

    def close(self) -> None:
        """Take it off the graph."""
        with self._wire.lock:
            super().close()
            self.is_there = False


def _value(endpoint: Any, key: str) -> str:
    """Return what the user data of an endpoint says; empty if it says nothing, or the endpoint has gone."""
    from cyclonedds.core import Policy

    data = None if endpoint is None else endpoint.qos[Policy.Userdata]
    return "" if data is None else read_endpoint_data(data.data).get(key, "")
