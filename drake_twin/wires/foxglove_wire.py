"""Foxglove's web socket: the topics for any viewer that speaks it, and, if asked for, commands and services."""

import contextlib
import threading
from collections.abc import Callable, Sequence
from typing import Any
from uuid import uuid4

from drake_twin.errors import InputError
from drake_twin.requirements import missing
from drake_twin.twin.twin import Twin
from drake_twin.wires.foxglove_clients import FoxgloveClients
from drake_twin.wires.foxglove_door import FoxgloveDoor, hidden_address
from drake_twin.wires.foxglove_graph import PUBLISHED, SERVED, SUBSCRIBED, FoxgloveGraph
from drake_twin.wires.foxglove_log import log_causes_once
from drake_twin.wires.foxglove_own_client import FoxgloveOwnClient
from drake_twin.wires.foxglove_parameters import EVENT, FoxgloveParameters
from drake_twin.wires.foxglove_service import CDR, JSON, FoxgloveService
from drake_twin.wires.foxglove_time import END, FoxgloveTime
from drake_twin.wires.wire import Closable, Nothing, Reply, Sender, WireEndpoint

PORT = 8765
_CLOCK = "rosgraph_msgs/msg/Clock"
_MOST_WAITING = 512  # messages for a client that reads slowly; the oldest are dropped
_FRAME = 10_000_000  # ns of simulated time between two broadcasts of it


class FoxgloveWire:
    """A server of Foxglove's web socket protocol.

    Topics are channels with CDR messages and ``ros2msg`` schemas. A topic that no client subscribes to costs nothing.
    The protocol has no token, so that it only shows, unless ``control`` is set. Web pages are refused, but for
    Foxglove's own.

    Args:
        host: The address to listen on.
        port: The port; 0 for any free one.
        control: Whether clients may publish commands, call services and control the time.
        end: The end of the time line on which clients control the time (s).
        asset: Returns the content of a file by its address, or None. It is called in other threads.
        origins: The origins of more web pages that may open it, such as ``http://localhost:8080``.

    Attributes:
        place: The address of the server.
        port: Its port.

    Raises:
        InputError: If the SDK is not installed, or the port cannot be opened.
    """

    def __init__(
        self,
        host: str = "127.0.0.1",
        port: int = PORT,
        *,
        control: bool = False,
        end: float = END,
        asset: Callable[[str], bytes | None] = lambda address: None,
        origins: Sequence[str] = (),
    ):
        try:
            import foxglove
            from foxglove.websocket import Capability
        except ImportError:
            raise missing("--foxglove needs", "foxglove") from None
        shown = Capability.Time, Capability.Parameters, Capability.ConnectionGraph
        capabilities = [*shown, *((Capability.ClientPublish, Capability.Services) if control else ())]
        self._context = foxglove.Context()
        self._graph = FoxgloveGraph(lambda graph: self._server.publish_connection_graph(graph))
        self._parameters = FoxgloveParameters()
        watched = self._graph.watch
        self._own_client = own = FoxgloveOwnClient()
        self._clients = FoxgloveClients(self._join, self._parameters, watched, own, control=control)
        self._control = control
        self._latest = self._told = -1
        self._servers: set[FoxgloveService] = set()
        self._time: FoxgloveTime | None = None
        log_causes_once()
        try:
            self._door = FoxgloveDoor(host, port, origins)
        except (OSError, OverflowError) as error:
            reason = str(getattr(error, "strerror", None) or error).partition(" (while")[0]
            raise InputError(f"--foxglove: {host}:{port} cannot be opened: {reason}") from None
        hidden = hidden_address()
        try:
            self._server = foxglove.start_server(
                name="drake_twin",
                host=hidden,
                port=0,
                capabilities=capabilities,
                server_listener=self._clients,
                supported_encodings=[CDR, JSON] if control else [],
                asset_handler=asset,
                context=self._context,
                session_id=uuid4().hex,
                message_backlog_size=_MOST_WAITING,
                playback_time_range=(0, round(end * 1e9)) if control else None,
            )
        except (RuntimeError, OSError, ValueError) as error:
            self._door.close()
            reason = str(error).rpartition("Failed to bind port: ")[2].partition(" (os error")[0]
            raise InputError(f"--foxglove: {hidden} cannot be opened: {reason}") from None
        self._address = hidden, self._server.port
        self._door.lead_to(self._address)
        self.port = self._door.port
        self.place = f"ws://{host}:{self.port}"

    def attach(self, twin: Twin) -> None:
        """Let clients control the time of a twin, if they may command."""
        if self._control:
            self._time = FoxgloveTime(twin, self._server.broadcast_playback_state)
            self._clients.control_time = self._time.request

    def advertise(self, topic: WireEndpoint, listened: Callable[[bool], None]) -> Sender:
        """Offer a topic; see `drake_twin.wires.wire.Wire`."""
        if not self._is_readable(topic):
            return Nothing()
        self._graph.add(PUBLISHED, topic)
        return _Sender(self, self._clients, topic, listened)

    def listen(self, topic: WireEndpoint, heard: Callable[[bytes], None]) -> Closable:
        """Hear a topic; see `drake_twin.wires.wire.Wire`."""
        self._graph.add(SUBSCRIBED, topic)
        if self._control:
            self._clients.heard[topic.name] = topic, heard

        ends = contextlib.ExitStack()
        ends.callback(self._clients.heard.pop, topic.name, None)
        ends.callback(self._graph.remove, SUBSCRIBED, topic)
        return ends

    def serve(self, service: WireEndpoint, answer: Callable[[bytes, Reply], None]) -> Closable:
        """Offer a service; see `drake_twin.wires.wire.Wire`."""
        self._graph.add(SERVED, service)
        self._parameters.add(service, answer)
        ends = contextlib.ExitStack()
        if self._control and self._is_readable(service):
            ends.callback(self._offer(service, answer).close)
        ends.callback(self._parameters.remove, service)
        ends.callback(self._graph.remove, SERVED, service)
        return ends

    def _offer(self, service: WireEndpoint, answer: Callable[[bytes, Reply], None]) -> Closable:
        """Let clients call a service in CDR, and in JSON by its name with ``.json``, which no name in ROS ends with.

        The protocol has one encoding for each service.
        """
        ends = contextlib.ExitStack()
        for name, encoding in ((service.name, CDR), (f"{service.name}.{JSON}", JSON)):
            server = FoxgloveService(name, service.type, encoding, answer, self._end)
            self._servers.add(server)
            self._server.add_services([server.offer()])
            ends.callback(server.close)
        return ends

    def _end(self, server: FoxgloveService) -> None:
        self._servers.discard(server)
        self._server.remove_services([server.name])

    def _is_readable(self, endpoint: WireEndpoint) -> bool:
        """Tell whether clients can read a type: it is known, and not made of an action's parts, which have no text."""
        if not endpoint.hash:
            self._clients.log(endpoint.name, f"it is not in Foxglove: the type {endpoint.type} is unknown")
        return bool(endpoint.hash) and "/action/" not in endpoint.type

    def close(self) -> None:
        """Stop the server; requests that wait for a response fail."""
        self._graph.close()
        if self._time is not None:
            self._time.close()
        for server in tuple(self._servers):
            server.close()
        self._server.stop()
        self._door.close()

    def open_channel(self, topic: WireEndpoint) -> Any:
        """Open the channel of a topic."""
        from foxglove import Channel, Schema

        schema = Schema(name=topic.type, encoding="ros2msg", data=topic.definition.encode())
        return Channel(topic.name, message_encoding=CDR, schema=schema, context=self._context)

    def forget(self, topic: WireEndpoint) -> None:
        """Forget a topic whose channel is closed."""
        self._graph.remove(PUBLISHED, topic)

    def follow_time(self, now: int) -> None:
        """Follow the simulation time (ns), in the sender's thread; when it jumps back, clients start over.

        They forget what they have heard, and the news may reach them after messages that were sent later. So latched
        topics are offered again: the offer, and with it the message, comes after the news.
        """
        if now < self._latest:
            self._server.clear_session(uuid4().hex)
            for sender in self._clients.senders():
                sender.renew()
        if now < self._latest or now >= self._told + _FRAME:
            self._told = now
            self._server.broadcast_time(now)
        self._latest = now

    def tell_parameters(self, data: bytes) -> None:
        """Tell clients of the parameters that an event (CDR) has changed."""
        if parameters := self._parameters.changed(data):
            self._own_client.publish(parameters, *self._address)

    def _join(self) -> None:
        """Tell a client that joins the time: the twin may be paused."""
        if self._latest >= 0:
            self._server.broadcast_time(self._latest)


class _Sender:
    """Sends the messages of a topic.

    The clock's are also sent as the time of all clients, and events of parameters as the values of these.

    Attributes:
        is_heard: Whether a client subscribes; always true for a topic whose message is kept for late joiners.
        is_clock: Whether the topic is the clock, which is followed while any client subscribes to anything.
        is_of_parameters: Whether it tells of changed parameters, which is followed while any client subscribes to some.
    """

    def __init__(
        self, wire: FoxgloveWire, clients: FoxgloveClients, topic: WireEndpoint, listened: Callable[[bool], None]
    ):
        self._is_latched = topic.latched and topic.kept == 1  # a log is not sent again to those that have it
        self.is_heard = self._is_latched
        self.is_clock, self.is_of_parameters = topic.type == _CLOCK, topic.type == EVENT
        self._wire, self._clients, self._topic, self._listened = wire, clients, topic, listened
        self._kept: tuple[bytes, int] | None = None
        self._is_closed = False
        self._lock = threading.Lock()
        self._open()

    def send(self, data: bytes, at: int) -> None:
        self._wire.follow_time(at)
        if self._is_latched:
            self._kept = data, at
        if self._clients.have(self._number):
            self._channel.log(data, log_time=at)
        if self.is_of_parameters and self._clients.follow_parameters:
            self._wire.tell_parameters(data)

    def follow(self, *, joined: bool) -> None:
        """Follow a client that has come or gone, in one of the server's threads."""
        clients = self._clients
        with clients.lock:
            is_heard = self._is_latched or (clients.are_there if self.is_clock else clients.have(self._number))
            is_heard = is_heard or (self.is_of_parameters and clients.follow_parameters)
            has_changed, self.is_heard = is_heard != self.is_heard, is_heard
        if has_changed:
            self._listened(is_heard)
        if joined and self._kept is not None:
            self._channel.log(self._kept[0], log_time=self._kept[1])  # others get it once more

    def renew(self) -> None:
        """Offer a latched topic again, so that clients subscribe again."""
        with self._lock:
            if self._is_latched and not self._is_closed:
                self._close()
                self._open()

    def close(self) -> None:
        self._wire.forget(self._topic)
        with self._lock:
            self._is_closed = True
            self._close()

    def _open(self) -> None:
        self._channel = self._wire.open_channel(self._topic)
        self._number: int = self._channel.id()
        self._clients.add(self._number, self)

    def _close(self) -> None:
        from foxglove.channel import _channels_by_id

        self._clients.remove(self._number)
        self._channel.close()
        _channels_by_id.pop(self._number, None)  # the SDK keeps each channel as long as the process lives
