"""Foxglove's web socket: the topics for any viewer that speaks it, and, if asked for, commands and services."""

import contextlib
import json
import logging
import socket
import threading
import time
from collections.abc import Callable
from typing import Any
from uuid import uuid4

from drake_twin.errors import InputError
from drake_twin.messages.interface_types import definition, make, serialize
from drake_twin.requirements import missing
from drake_twin.wires.foxglove_log import log_causes_once
from drake_twin.wires.foxglove_service import FoxgloveService
from drake_twin.wires.wire import LARGEST, Closable, Reply, Sender, WireEndpoint

_log = logging.getLogger(__name__)
PORT = 8765
_CLOCK = "rosgraph_msgs/msg/Clock"
_MOST_WAITING = 512  # messages for a client that reads slowly; the oldest are dropped
_FRAME = 10_000_000  # ns of simulated time between two broadcasts of it
_LONGEST_CLOSE = 2.0  # s of wall time
_MOST_LINES = 100  # of the log
_MOST_CHANNELS = 1000  # that clients may offer at the same time
_CDR, _JSON = "cdr", "json"


class FoxgloveWire:
    """A server of Foxglove's web socket protocol.

    Topics are channels with CDR messages and ``ros2msg`` schemas. A topic that no client subscribes to costs nothing.
    The protocol has no token, and any web page can open the port, so that it only shows, unless ``control`` is set.

    Args:
        host: The address to listen on.
        port: The port; 0 for any free one.
        control: Whether clients may publish commands and call services.
        asset: Returns the content of a file by its address, or None. It is called in other threads.

    Attributes:
        place: The address of the server.

    Raises:
        InputError: If the SDK is not installed, or the port cannot be opened.
    """

    def __init__(
        self,
        host: str = "127.0.0.1",
        port: int = PORT,
        *,
        control: bool = False,
        asset: Callable[[str], bytes | None] = lambda address: None,
    ):
        try:
            import foxglove
            from foxglove.websocket import Capability
        except ImportError:
            raise missing("--foxglove needs", "foxglove") from None
        capabilities = [Capability.Time, *((Capability.ClientPublish, Capability.Services) if control else ())]
        self._context = foxglove.Context()
        self._clients = _Clients(self._join)
        self._control = control
        self._latest = self._told = -1
        self._servers: set[FoxgloveService] = set()
        log_causes_once()
        try:
            self._server = foxglove.start_server(
                name="drake_twin",
                host=host,
                port=port,
                capabilities=capabilities,
                server_listener=self._clients,
                supported_encodings=[_CDR, _JSON] if control else [],
                asset_handler=asset,
                context=self._context,
                session_id=uuid4().hex,
                message_backlog_size=_MOST_WAITING,
            )
        except (RuntimeError, OSError, ValueError) as error:
            reason = str(error).rpartition("Failed to bind port: ")[2].partition(" (os error")[0]
            raise InputError(f"--foxglove: {host}:{port} cannot be opened: {reason}") from None
        self._address = host, self._server.port
        self.place = f"ws://{host}:{self._server.port}"

    def advertise(self, topic: WireEndpoint, listened: Callable[[bool], None]) -> Sender:
        """Offer a topic; see `drake_twin.wires.wire.Wire`."""
        if not self._is_readable(topic):
            return _Nothing()
        return _Sender(self, self._clients, topic, listened)

    def listen(self, topic: WireEndpoint, heard: Callable[[bytes], None]) -> Closable:
        """Hear a topic; see `drake_twin.wires.wire.Wire`."""
        if not self._control:
            return _Nothing()
        self._clients.heard[topic.name] = topic, heard
        return _End(lambda: self._clients.heard.pop(topic.name, None))

    def serve(self, service: WireEndpoint, answer: Callable[[bytes, Reply], None]) -> Closable:
        """Offer a service; see `drake_twin.wires.wire.Wire`."""
        if not self._control or not self._is_readable(service):
            return _Nothing()
        from foxglove import Schema
        from foxglove.websocket import MessageSchema, Service, ServiceSchema

        def schema(part: str) -> MessageSchema:
            name = f"{service.type}_{part}"
            text = Schema(name=name, encoding="ros2msg", data=definition(name).encode())
            return MessageSchema(encoding=_CDR, schema=text)

        def end(server: FoxgloveService) -> None:
            self._servers.discard(server)
            self._server.remove_services([service.name])

        server = FoxgloveService(service.name, answer, end)
        self._servers.add(server)
        parts = ServiceSchema(service.type, request=schema("Request"), response=schema("Response"))
        self._server.add_services([Service(service.name, schema=parts, handler=server.handle)])
        return server

    def _is_readable(self, endpoint: WireEndpoint) -> bool:
        """Tell whether clients can read a type: it is known, and not made of an action's parts, which have no text."""
        if not endpoint.hash:
            self._clients.log(endpoint.name, f"it is not in Foxglove: the type {endpoint.type} is unknown")
        return bool(endpoint.hash) and "/action/" not in endpoint.type

    def close(self) -> None:
        """Stop the server; requests that wait for a response fail."""
        for server in tuple(self._servers):
            server.close()
        self._server.stop()
        end = time.monotonic() + _LONGEST_CLOSE
        while not _is_free(*self._address) and time.monotonic() < end:  # it returns before the port is free
            time.sleep(0.01)

    def open_channel(self, topic: WireEndpoint) -> Any:
        """Open the channel of a topic."""
        from foxglove import Channel, Schema

        schema = Schema(name=topic.type, encoding="ros2msg", data=topic.definition.encode())
        return Channel(topic.name, message_encoding=_CDR, schema=schema, context=self._context)

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

    def _join(self) -> None:
        """Tell a client that joins the time: the twin may be paused."""
        if self._latest >= 0:
            self._server.broadcast_time(self._latest)


def _is_free(host: str, port: int) -> bool:
    with contextlib.suppress(OSError), socket.create_server((host, port)):
        return True
    return False


class _Nothing:
    """Stands for what is not offered."""

    is_heard = False

    def send(self, data: bytes, at: int) -> None:
        """Send nothing."""

    def close(self) -> None:
        """Nothing is to be ended."""


class _End:
    def __init__(self, close: Callable[[], object]):
        self._close = close

    def close(self) -> None:
        self._close()


class _Sender:
    """Sends the messages of a topic; the clock's are also sent as the time of all clients.

    Attributes:
        is_heard: Whether a client subscribes; always true for a topic whose message is kept for late joiners.
        is_clock: Whether the topic is the clock, which is followed while any client subscribes to anything.
    """

    def __init__(self, wire: FoxgloveWire, clients: "_Clients", topic: WireEndpoint, listened: Callable[[bool], None]):
        self.is_heard = topic.latched
        self.is_clock = topic.type == _CLOCK
        self._wire, self._clients, self._topic, self._listened = wire, clients, topic, listened
        self._kept: tuple[bytes, int] | None = None
        self._is_closed = False
        self._lock = threading.Lock()
        self._open()

    def send(self, data: bytes, at: int) -> None:
        self._wire.follow_time(at)
        if self._topic.latched:
            self._kept = data, at
        if self._clients.have(self._number):
            self._channel.log(data, log_time=at)

    def follow(self, *, joined: bool) -> None:
        """Follow a client that has come or gone, in one of the server's threads."""
        clients = self._clients
        with clients.lock:
            is_heard = self._topic.latched or (clients.are_there if self.is_clock else clients.have(self._number))
            has_changed, self.is_heard = is_heard != self.is_heard, is_heard
        if has_changed:
            self._listened(is_heard)
        if joined and self._kept is not None:
            self._channel.log(self._kept[0], log_time=self._kept[1])  # others get it once more

    def renew(self) -> None:
        """Offer a latched topic again, so that clients subscribe again."""
        with self._lock:
            if self._topic.latched and not self._is_closed:
                self._close()
                self._open()

    def close(self) -> None:
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


class _Clients:
    """What clients do; the methods ``on_…`` are called in the server's threads.

    Subscribers are counted here: a channel cannot be asked for them while another thread closes it.

    Args:
        joined: Called for a client that joins others.

    Attributes:
        heard: Topic → its endpoint and what hears its messages.
        lock: Guards the subscribers. The server is not called with it held, for it calls back with locks of its own.
    """

    def __init__(self, joined: Callable[[], None]):
        self._joined = joined
        self.lock = threading.Lock()
        self._senders: dict[int, _Sender] = {}
        self._subscribers: dict[int, set[int]] = {}  # channel → clients
        self.heard: dict[str, tuple[WireEndpoint, Callable[[bytes], None]]] = {}
        self._channels: dict[tuple[int, int], Any] = {}
        self._logged: set[tuple[str, str]] = set()

    @property
    def are_there(self) -> bool:
        """Whether any client subscribes to anything."""
        return bool(self._subscribers)

    def have(self, channel: int) -> bool:
        """Tell whether any client subscribes to a channel."""
        return bool(self._subscribers.get(channel))

    def add(self, channel: int, sender: _Sender) -> None:
        """Add a channel, which clients may have found already."""
        with self.lock:
            self._senders[channel] = sender
        sender.follow(joined=False)

    def remove(self, channel: int) -> None:
        """Remove a channel."""
        with self.lock:
            self._senders.pop(channel, None)
            self._subscribers.pop(channel, None)

    def senders(self) -> tuple[_Sender, ...]:
        """Return the senders of all channels."""
        with self.lock:
            return tuple(self._senders.values())

    def on_subscribe(self, client: Any, channel: Any) -> None:
        with self.lock:
            joins_others = self.are_there  # without any, nothing follows the time
            self._subscribers.setdefault(channel.id, set()).add(client.id)
        self._follow(channel.id, joined=True)
        if joins_others:
            self._joined()

    def on_unsubscribe(self, client: Any, channel: Any) -> None:
        with self.lock:
            clients = self._subscribers.get(channel.id, set())
            clients.discard(client.id)
            if not clients:
                self._subscribers.pop(channel.id, None)
        self._follow(channel.id, joined=False)

    def on_client_advertise(self, client: Any, channel: Any) -> None:
        if channel.topic not in self.heard:
            self.log(channel.topic, "nothing listens to it")
        elif channel.encoding not in (_CDR, _JSON):
            self.log(channel.topic, f"the encoding {channel.encoding!r} is not read: {_CDR} and {_JSON} are")
        elif len(self._channels) >= _MOST_CHANNELS:
            self.log(channel.topic, f"more than {_MOST_CHANNELS} channels of clients")
        else:
            topic, _ = self.heard[channel.topic]
            if channel.schema_name not in (topic.type, topic.type.replace("/msg/", "/")):
                self.log(topic.name, f"a {channel.schema_name} is ignored: the topic's type is {topic.type}")
                return
            self._channels[client.id, channel.id] = channel

    def on_client_unadvertise(self, client: Any, client_channel_id: int) -> None:
        self._channels.pop((client.id, client_channel_id), None)

    def on_message_data(self, client: Any, client_channel_id: int, data: bytes) -> None:
        channel = self._channels.get((client.id, client_channel_id))
        if channel is None or channel.topic not in self.heard:
            return
        topic, heard = self.heard[channel.topic]
        if len(data) > LARGEST:
            self.log(topic.name, f"a message of more than {LARGEST} bytes is ignored")
            return
        if channel.encoding == _JSON:
            try:
                data = serialize(make(topic.type, json.loads(data)))
            except (ValueError, RecursionError) as error:  # a UnicodeDecodeError, too
                self.log(topic.name, f"a message is not a {topic.type}: {error}", "decoding")
                return
        heard(data)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("on_"):  # what clients do beside it is of no interest
            return lambda *_: None
        raise AttributeError(name)

    def _follow(self, channel: int, *, joined: bool) -> None:
        for number, sender in tuple(self._senders.items()):
            if number == channel or sender.is_clock:
                sender.follow(joined=joined and number == channel)

    def log(self, topic: str, text: str, cause: str = "") -> None:
        """Log once per topic and cause."""
        key = topic, cause or text
        if key not in self._logged and len(self._logged) < _MOST_LINES:
            self._logged.add(key)
            _log.warning("%s: %s", topic, text)
