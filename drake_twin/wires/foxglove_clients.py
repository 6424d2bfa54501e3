"""What clients of Foxglove do: whom they listen to, what they publish, and which parameters they ask for."""

import logging
import threading
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from drake_twin.messages.interface_types import serialize
from drake_twin.messages.json_messages import from_json
from drake_twin.wires.foxglove_own_client import FoxgloveOwnClient
from drake_twin.wires.foxglove_parameters import FoxgloveParameters
from drake_twin.wires.foxglove_service import CDR, JSON
from drake_twin.wires.wire import WireEndpoint

if TYPE_CHECKING:
    from foxglove.websocket import Parameter, PlaybackState

_log = logging.getLogger(__name__)
_MOST_LINES = 100  # of the log
_MOST_CHANNELS = 1000  # that clients may offer at the same time


class Followed(Protocol):
    """A topic whose listeners are followed.

    Attributes:
        is_clock: Whether it is followed while any client subscribes to anything.
        is_of_parameters: Whether it is followed while any client subscribes to parameters.
    """

    is_clock: bool
    is_of_parameters: bool

    def follow(self, *, joined: bool) -> None:
        """Follow a client that has come or gone."""

    def renew(self) -> None:
        """Offer the topic again, where clients have to subscribe again."""


class FoxgloveClients:
    """What clients do; the methods ``on_…`` are called in the server's threads.

    Subscribers are counted here: a channel cannot be asked for them while another thread closes it.

    Args:
        joined: Called for a client that joins others.
        parameters: What clients read, and set if they may command.
        watched: Called with whether any client watches the connection graph.
        own: The client that lets the server publish parameters.
        control: Whether clients may command.

    Attributes:
        heard: Topic → its endpoint and what hears its messages.
        follow_parameters: Whether any client subscribes to parameters.
        control_time: Does a client's request to control the time, and returns the state of the time then.
        lock: Guards the subscribers. The server is not called with it held, for it calls back with locks of its own.
    """

    def __init__(
        self,
        joined: Callable[[], None],
        parameters: FoxgloveParameters,
        watched: Callable[[bool], None],
        own: FoxgloveOwnClient,
        *,
        control: bool,
    ):
        self._joined, self._watched, self._own = joined, watched, own
        self._parameters, self._control = parameters, control
        self.lock = threading.Lock()
        self._senders: dict[int, Followed] = {}
        self._subscribers: dict[int, set[int]] = {}  # channel → clients
        self.heard: dict[str, tuple[WireEndpoint, Callable[[bytes], None]]] = {}
        self._channels: dict[tuple[int, int], Any] = {}
        self._parameter_names: set[str] = set()
        self.follow_parameters = False
        self.control_time: Callable[[Any], PlaybackState | None] = lambda request: None
        self._logged: set[tuple[str, str]] = set()

    @property
    def are_there(self) -> bool:
        """Whether any client subscribes to anything."""
        return bool(self._subscribers)

    def have(self, channel: int) -> bool:
        """Tell whether any client subscribes to a channel."""
        return bool(self._subscribers.get(channel))

    def add(self, channel: int, sender: Followed) -> None:
        """Add a channel, which clients may have found already."""
        with self.lock:
            self._senders[channel] = sender
        sender.follow(joined=False)

    def remove(self, channel: int) -> None:
        """Remove a channel."""
        with self.lock:
            self._senders.pop(channel, None)
            self._subscribers.pop(channel, None)

    def senders(self) -> tuple[Followed, ...]:
        """Return the senders of all channels."""
        with self.lock:
            return tuple(self._senders.values())

    def on_subscribe(self, client: Any, channel: Any) -> None:
        """A client subscribes to a channel."""
        with self.lock:
            joins_others = self.are_there  # without any, nothing follows the time
            self._subscribers.setdefault(channel.id, set()).add(client.id)
        self._follow(channel.id, joined=True)
        if joins_others:
            self._joined()

    def on_unsubscribe(self, client: Any, channel: Any) -> None:
        """A client unsubscribes, or leaves."""
        with self.lock:
            clients = self._subscribers.get(channel.id, set())
            clients.discard(client.id)
            if not clients:
                self._subscribers.pop(channel.id, None)
        self._follow(channel.id, joined=False)

    def on_client_advertise(self, client: Any, channel: Any) -> None:
        """A client offers a channel."""
        if channel.topic not in self.heard:
            self.log(channel.topic, "nothing listens to it")
        elif channel.encoding not in (CDR, JSON):
            self.log(channel.topic, f"the encoding {channel.encoding!r} is not read: {CDR} and {JSON} are")
        elif len(self._channels) >= _MOST_CHANNELS:
            self.log(channel.topic, f"more than {_MOST_CHANNELS} channels of clients")
        else:
            topic, _ = self.heard[channel.topic]
            if channel.schema_name not in (topic.type, topic.type.replace("/msg/", "/")):
                self.log(topic.name, f"a {channel.schema_name} is ignored: the topic's type is {topic.type}")
                return
            self._channels[client.id, channel.id] = channel

    def on_client_unadvertise(self, client: Any, client_channel_id: int) -> None:
        """A client takes its channel back."""
        self._channels.pop((client.id, client_channel_id), None)

    def on_message_data(self, client: Any, client_channel_id: int, data: bytes) -> None:
        """A client publishes."""
        channel = self._channels.get((client.id, client_channel_id))
        if channel is None or channel.topic not in self.heard:
            return
        topic, heard = self.heard[channel.topic]
        if len(data) > topic.largest:
            self.log(topic.name, f"a message of more than {topic.largest} bytes is ignored")
            return
        if channel.encoding == JSON:
            try:
                data = serialize(from_json(topic.type, data))
            except ValueError as error:  # a UnicodeDecodeError, too
                self.log(topic.name, f"a message is not a {topic.type}: {error}", "decoding")
                return
        heard(data)

    def on_get_parameters(
        self, client: Any, param_names: Sequence[str], request_id: str | None = None
    ) -> "list[Parameter]":
        """A client asks for parameters, or for all."""
        return self._parameters.get(param_names)

    def on_set_parameters(
        self, client: Any, parameters: "Sequence[Parameter]", request_id: str | None = None
    ) -> "list[Parameter]":
        """A client sets parameters: return what they are now."""
        if request_id == self._own.request:
            return self._own.take()
        values = {item.name: item.get_value() for item in parameters}
        if self._control:
            for reason in self._parameters.set(values):
                self.log("a parameter is not set", reason)
        else:
            self.log("a parameter is not set", "--foxglove-control lets clients command", "control")
        return self._parameters.get(values) if values else []

    def on_parameters_subscribe(self, param_names: Sequence[str]) -> None:
        """Clients subscribe to parameters that none subscribed to."""
        self._follow_parameters(self._parameter_names.union(param_names))

    def on_parameters_unsubscribe(self, param_names: Sequence[str]) -> None:
        """No client subscribes to these parameters any more."""
        self._follow_parameters(self._parameter_names.difference(param_names))

    def on_playback_control_request(self, playback_control_request: Any) -> "PlaybackState | None":
        """A client controls the time."""
        return self.control_time(playback_control_request)

    def on_connection_graph_subscribe(self) -> None:
        """The first client watches the connection graph."""
        self._watched(True)

    def on_connection_graph_unsubscribe(self) -> None:
        """The last client stops to watch it."""
        self._watched(False)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("on_"):  # what clients do beside it is of no interest
            return lambda *_: None
        raise AttributeError(name)

    def _follow_parameters(self, names: set[str]) -> None:
        self._parameter_names, self.follow_parameters = names, bool(names)  # the server calls with a lock of its own
        for sender in self.senders():
            if sender.is_of_parameters:
                sender.follow(joined=False)

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
