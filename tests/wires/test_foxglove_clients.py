"""Who listens to Foxglove's wire, with its SDK and without a client; its requests that wait; what its SDK logs."""

import json
import logging
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from drake_twin.wires.foxglove_clients import FoxgloveClients
from drake_twin.wires.foxglove_graph import PUBLISHED, SERVED, SUBSCRIBED
from drake_twin.wires.foxglove_own_client import FoxgloveOwnClient
from drake_twin.wires.foxglove_parameters import FoxgloveParameters
from drake_twin.wires.foxglove_wire import FoxgloveWire
from drake_twin.wires.wire import LARGEST, WireEndpoint

pytest.importorskip("foxglove", reason="foxglove-sdk is not installed")

JAZZY = get_typestore(Stores.ROS2_JAZZY)
ARRAY, TWIST = "std_msgs/msg/Float64MultiArray", "geometry_msgs/msg/TwistStamped"
TEXT = WireEndpoint("/text", "std_msgs/msg/String", "RIHS01_0", "/node", definition="string data")
LATCHED = WireEndpoint("/latched", "std_msgs/msg/String", "RIHS01_0", "/node", True, "string data")
CLOCK = WireEndpoint("/clock", "rosgraph_msgs/msg/Clock", "RIHS01_0", "/node", definition="int32 sec")
TRIGGER = WireEndpoint("/trigger", "std_srvs/srv/Trigger", "RIHS01_0", "/node")


@pytest.fixture
def wire():
    wire = FoxgloveWire(port=0, control=True)
    yield wire
    wire.close()


class Heard:
    """Who listens to a topic, as the seam is told."""

    def __init__(self, wire, topic):
        self.told = []
        self.sender = wire.advertise(topic, self.told.append)

    def subscribe(self, wire, client, end=False):
        """Do what the server does when a client subscribes."""
        call = wire._clients.on_unsubscribe if end else wire._clients.on_subscribe
        call(SimpleNamespace(id=client), SimpleNamespace(id=self.sender._number))


def said(caplog):
    """The program's lines; pytest shows those of the SDK's own loggers, too, which the program does not."""
    return [record.getMessage() for record in caplog.records if record.name.startswith("drake_twin")]


def test_a_topic_is_heard_while_any_client_subscribes(wire):
    text = Heard(wire, TEXT)
    assert not text.sender.is_heard
    assert not text.sender._channel.has_sinks()
    for client, end in ((1, False), (2, False), (1, True)):
        text.subscribe(wire, client, end)
    assert text.sender.is_heard
    text.subscribe(wire, 2, end=True)
    assert text.told == [True, False]
    assert not text.sender.is_heard


def test_a_latched_topic_is_always_heard_for_its_last_message_is_kept(wire):
    latched = Heard(wire, LATCHED)
    assert latched.sender.is_heard
    latched.subscribe(wire, 1)
    latched.subscribe(wire, 1, end=True)
    assert latched.told == []
    assert latched.sender.is_heard


def test_the_clock_is_heard_while_a_client_subscribes_to_anything(wire):
    clock, latched = Heard(wire, CLOCK), Heard(wire, LATCHED)
    latched.subscribe(wire, 1)
    assert clock.sender.is_heard
    clock.subscribe(wire, 1)
    latched.subscribe(wire, 1, end=True)
    assert clock.told == [True]
    clock.subscribe(wire, 1, end=True)
    assert clock.told == [True, False]


def test_a_client_that_finds_a_channel_while_it_is_opened_is_not_lost(wire, monkeypatch):
    open_channel = wire.open_channel

    def found_at_once(topic):
        channel = open_channel(topic)
        wire._clients.on_subscribe(SimpleNamespace(id=1), SimpleNamespace(id=channel.id()))
        return channel

    monkeypatch.setattr(wire, "open_channel", found_at_once)
    assert Heard(wire, TEXT).sender.is_heard


def test_a_topic_that_ends_leaves_nothing(wire):
    from foxglove.channel import _channels_by_id

    known = len(_channels_by_id)
    for _ in range(20):
        text = Heard(wire, TEXT)
        text.subscribe(wire, 1)
        text.sender.close()
    assert wire._clients.senders() == ()
    assert not wire._clients.are_there
    assert len(_channels_by_id) == known


def test_what_has_no_text_is_not_offered(wire, caplog):
    for _ in range(2):
        assert not Heard(wire, WireEndpoint("/own", "own_msgs/msg/Own", "", "/node")).sender.is_heard
    Heard(wire, WireEndpoint("/f", "control_msgs/action/GripperCommand_FeedbackMessage", "RIHS01_0", "/node"))
    assert wire._clients.senders() == ()
    assert said(caplog) == ["/own: it is not in Foxglove: the type own_msgs/msg/Own is unknown"]


def test_a_topic_of_empty_messages_is_offered(wire):
    Heard(wire, WireEndpoint("/empty", "std_msgs/msg/Empty", "RIHS01_0", "/node"))
    assert len(wire._clients.senders()) == 1


def test_a_service_that_ends_fails_the_requests_that_wait(wire):
    """As when its robot is deleted while they wait."""
    asked = []
    offered = wire.serve(TRIGGER, lambda data, reply: asked.append(reply))
    (server,) = (item for item in wire._servers if item.name == "/trigger")
    request = SimpleNamespace(payload=b"request")
    with ThreadPoolExecutor(2) as threads:
        waiting = threads.submit(server.handle, request)
        while not asked:
            assert not waiting.done()
        answered = threads.submit(server.handle, request)
        while len(asked) < 2:
            assert not answered.done()
        asked[1](b"answer")
        assert answered.result() == b"answer"
        offered.close()
        with pytest.raises(RuntimeError, match="/trigger has ended"):
            waiting.result()
    asked[0](b"too late")
    with pytest.raises(RuntimeError, match="/trigger has ended"):
        server.handle(request)
    wire.serve(TRIGGER, lambda data, reply: None)  # its name is free again


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.sampled_from(["data", "twist", "linear", "x", "header", "stamp", "sec", "layout"]), inner)
    ),
    max_leaves=8,
)


@settings(max_examples=300, deadline=None)
@given(value=JSON, noise=st.binary(max_size=30))
def test_any_json_is_a_message_or_refused(value, noise):
    wire = SimpleNamespace(heard=[])
    for kind in (ARRAY, TWIST):
        clients = _listening(kind, wire.heard.append)
        for data in (json.dumps(value).encode(), noise, b"[" * 10_000):
            clients.on_message_data(SimpleNamespace(id=1), 1, data)
        for data in wire.heard:
            assert JAZZY.deserialize_cdr(data, kind).__msgtype__ == kind
        wire.heard.clear()


def _listening(kind, heard):
    """Clients of which one offers JSON on a topic that is listened to."""
    clients = FoxgloveClients(
        lambda: None, FoxgloveParameters(), lambda is_watched: None, FoxgloveOwnClient(), control=True
    )
    clients.heard["/topic"] = WireEndpoint("/topic", kind, "RIHS01_0", "/node"), heard
    channel = SimpleNamespace(id=1, topic="/topic", encoding="json", schema_name=kind)
    clients.on_client_advertise(SimpleNamespace(id=1), channel)
    return clients


def test_a_message_that_is_too_large_is_one_line_of_the_log(caplog):
    heard = []
    clients = _listening(ARRAY, heard.append)
    client, channel = SimpleNamespace(id=1), SimpleNamespace(id=2, topic="/topic", encoding="cdr", schema_name=ARRAY)
    clients.on_client_advertise(client, channel)
    for _ in range(2):
        clients.on_message_data(client, 2, bytes(LARGEST + 1))
    assert heard == []
    assert said(caplog) == [f"/topic: a message of more than {LARGEST} bytes is ignored"]
    clients.on_message_data(client, 2, bytes(LARGEST))
    assert heard == [bytes(LARGEST)]


def test_what_ends_leaves_the_connection_graph(wire, monkeypatch):
    graph = set()
    own = SimpleNamespace(
        add=lambda kind, endpoint: graph.add((kind, endpoint.name)),
        remove=lambda kind, endpoint: graph.remove((kind, endpoint.name)),
        close=lambda: None,
    )
    monkeypatch.setattr(wire, "_graph", own)
    ends = [wire.advertise(TEXT, lambda is_heard: None), wire.listen(LATCHED, lambda data: None)]
    ends.append(wire.serve(TRIGGER, lambda data, reply: None))
    assert graph == {(PUBLISHED, "/text"), (SUBSCRIBED, "/latched"), (SERVED, "/trigger")}
    for end in ends:
        end.close()
    assert graph == set()


def test_what_the_sdk_logs_is_said_once_without_the_clients_address(caplog):
    FoxgloveWire(port=0).close()
    sdk = logging.getLogger("foxglove.websocket.connected_client")
    for port in range(3):
        sdk.error("Invalid message from 127.0.0.1:%d: of a test, with %d bytes", 4000 + port, port)
        sdk.error("Error receiving from client 127.0.0.1:%d: IO error: Connection reset by peer (os error 104)", port)
        sdk.info("not for users")
    assert said(caplog) == ["foxglove: Invalid message from a client: of a test, with 0 bytes"]
