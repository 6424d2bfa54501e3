"""What bad peers do over Foxglove's web socket: the twin runs on, memory is bounded, each cause is logged once."""

import base64
import random
import socket
import threading
from itertools import pairwise
from pathlib import Path

import pytest
from conftest import rovers
from wires.foxglove_client import foxglove_client
from wires.ros_client import while_running

from drake_twin.messages import message
from drake_twin.messages.interface_types import serialize
from drake_twin.services.graph import connect
from drake_twin.wires.foxglove_wire import FoxgloveWire
from drake_twin.wires.wire import WireEndpoint

pytest.importorskip("foxglove")

STATES = "/robot_1/joint_states"
COMMANDS, ARRAY = "/robot_1/forward_velocity_controller/commands", "std_msgs/msg/Float64MultiArray"
SWITCH = "/robot_1/controller_manager/switch_controller"
LYING = b"\x00\x01\x00\x00" + b"\x00" * 8 + b"\xff\xff\xff\xff" + bytes(32)


@pytest.fixture
def wire():
    return FoxgloveWire(port=0, control=True)


@pytest.fixture
def twin(wire):
    with rovers(1).build() as twin:
        seam = connect(twin, [wire])
        try:
            yield twin
        finally:
            seam.close()


def array(*values):
    return serialize(message(ARRAY, values))


def good_command(peer, value=1.5):
    """A command, and a request after it, so that it has been done once the answer is there."""
    peer.advertise(COMMANDS, ARRAY)(array(*[value] * 4))
    while not (answer := peer.call(SWITCH))["ok"]:  # after a flood there may be no room for a request for a while
        assert "too many requests wait" in str(answer)


def lines(caplog, start):
    """The lines about a topic; pytest shows those of the SDK's own loggers, too, which the program does not."""
    own = [record.getMessage() for record in caplog.records if record.name.startswith("drake_twin")]
    return [text for text in own if text.startswith(f"{start}: ")]


def memory():
    """The resident memory of this process (MiB)."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 >> 20


def threads():
    """The threads of this process, but those that the SDK keeps for its next server."""
    names = [file.read_text().strip() for file in Path("/proc/self/task").glob("*/comm")]
    return len([name for name in names if name != "tokio-rt-worker"])


def test_random_bytes_and_lengths_that_lie(twin, wire, caplog):
    chance = random.Random(17)

    def send():
        with foxglove_client(wire.port) as peer:
            publish = peer.advertise(COMMANDS, ARRAY)
            for _ in range(100):
                publish(chance.randbytes(chance.randrange(64)))
                publish(LYING)
                peer.do("raw", data=base64.b64encode(chance.randbytes(chance.randrange(64))).decode())
                peer.do("raw", text='{"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 99999}]}')
                peer.do("raw", text='{"op": ')
            for size in range(1, 6):
                assert not peer.call(SWITCH, data=b"\xff" * size)["ok"]
            good_command(peer)

    before = twin.time
    while_running(twin, send)
    assert twin.time > before
    assert list(twin.graph.command(COMMANDS).data) == [1.5] * 4
    assert 1 <= len(lines(caplog, COMMANDS)) <= 3
    assert 1 <= len(lines(caplog, SWITCH)) <= 2
    assert len(lines(caplog, "foxglove")) < 30  # one a kind of problem that the SDK finds, not one a message


def test_what_does_not_speak_the_protocol(twin, wire, caplog):
    chance = random.Random(18)

    def send():
        for _ in range(50):
            with socket.create_connection(("127.0.0.1", wire.port)) as other:
                other.sendall(chance.randbytes(1000) + b"\r\n\r\n")
        with foxglove_client(wire.port) as peer:
            good_command(peer)

    while_running(twin, send)
    assert list(twin.graph.command(COMMANDS).data) == [1.5] * 4
    assert len(lines(caplog, "foxglove")) <= 3


def test_a_message_of_2_and_one_of_100_megabytes(twin, wire, caplog):
    def send():
        before = memory()
        with foxglove_client(wire.port) as peer:
            peer.advertise(COMMANDS, ARRAY)
            for _ in range(3):
                peer.do("publishZeros", channel=1, size=2 << 20)
            good_command(peer, 2.5)
        for _ in range(3):
            with foxglove_client(wire.port) as peer:
                peer.do("zeros", size=100 << 20)
                peer.first("close")  # the server ends the connection
        with foxglove_client(wire.port) as peer:
            good_command(peer)
        return memory() - before

    assert while_running(twin, send) < 100
    assert list(twin.graph.command(COMMANDS).data) == [1.5] * 4
    assert lines(caplog, COMMANDS) == [f"{COMMANDS}: a message of more than 1048576 bytes is ignored"]


def test_a_flood_of_commands(twin, wire):
    def send():
        with foxglove_client(wire.port) as peer:
            good_command(peer)
            before = memory()
            channel = peer.all("advertised")[-1]["channel"]
            peer.do("flood", channel=channel, count=20_000, data=base64.b64encode(array(1, 2, 3, 4)).decode())
            good_command(peer, 2.5)
            return memory() - before

    assert while_running(twin, send) < 100
    assert list(twin.graph.command(COMMANDS).data) == [2.5] * 4


def test_a_client_that_advertises_without_end(twin, wire, caplog):
    def send():
        with foxglove_client(wire.port) as peer:
            for _ in range(1200):
                peer.do("advertise", topic=COMMANDS, schemaName=ARRAY, encoding="cdr")
            assert peer.call(SWITCH)["ok"]
        with foxglove_client(wire.port) as peer:  # the room is free again
            good_command(peer)

    while_running(twin, send)
    assert list(twin.graph.command(COMMANDS).data) == [1.5] * 4
    assert lines(caplog, COMMANDS) == [f"{COMMANDS}: more than 1000 channels of clients"]


def test_50_clients_come_and_leave(twin, wire):
    """Each leaves without a word, with a subscription, a channel and a call that waits."""

    def send():
        with foxglove_client(wire.port) as peer:
            peer.do("joinAndLeave", count=5, topic=STATES, service=SWITCH)
            peer.first("left", count=5)
            before = memory(), threads()
            peer.do("joinAndLeave", count=50, topic=STATES, service=SWITCH)
            peer.first("left", count=50)
            good_command(peer)
            return memory() - before[0], threads() - before[1]

    grown, more = while_running(twin, send)
    assert grown < 30
    assert more <= 0
    twin.advance_to(twin.time + 0.1)
    assert not wire._clients.are_there
    assert wire._clients._channels == {}
    assert twin._session.subscriptions.due_step == float("inf")


def test_a_client_that_stops_reading(twin, wire):
    """Its messages are dropped; another client and the simulation do not notice."""

    def send():
        with foxglove_client(wire.port) as lazy, foxglove_client(wire.port) as peer:
            lazy.subscribe(STATES)
            lazy.messages(STATES)
            lazy.do("stopReading")
            peer.subscribe(STATES)
            before = memory()
            times = [int(item["time"]) for item in peer.messages(STATES, 300)]
            good_command(peer)
            return times, memory() - before

    times, grown = while_running(twin, send, as_fast_as_possible=False)
    assert len(times) >= 300
    assert {after - before for before, after in pairwise(times[1:])} == {10_000_000}
    assert grown < 50


def test_what_a_client_that_stops_reading_has_not_read_is_bounded():
    """500 MB for it: at most 512 messages wait, and what the operating system takes."""
    wire = FoxgloveWire(port=0)
    try:
        text = WireEndpoint("/text", "std_msgs/msg/String", "RIHS01_0", "/node", definition="string data")
        sender = wire.advertise(text, lambda is_heard: None)
        with foxglove_client(wire.port) as lazy:
            lazy.subscribe("/text")
            lazy.do("stopReading")
            before = memory()
            data = serialize(message("std_msgs/msg/String", {"data": "x" * 50_000}))
            while not sender.is_heard:
                lazy.channel("/text")
            for time in range(10_000):
                sender.send(data, time)
            assert memory() - before < 80
            assert sender.is_heard  # it has not been sent away
    finally:
        wire.close()


def test_what_is_closed_leaves_no_thread_no_port_and_no_request_that_waits():
    def once():
        wire = FoxgloveWire(port=0, control=True)
        with rovers(1).build() as twin:
            seam = connect(twin, [wire])
            answers = wire._servers
            with foxglove_client(wire.port) as peer:
                peer.subscribe(STATES)
                peer.send_call(SWITCH)  # of a twin that does not run
                while not (waiting := [server for server in answers if server._waiting]):
                    twin.inbox.wait(1.0)
                assert [server.name for server in waiting] == [SWITCH]
                seam.close()
                peer.first("close")
                for _ in range(1000):
                    if waiting[0]._waiting:  # each is taken out in its own thread
                        twin.inbox.wait(0.01)
                assert waiting[0]._waiting == set()
        with socket.create_server(("127.0.0.1", wire.port)):
            pass

    def own():
        return {item for item in threading.enumerate() if not isinstance(item, threading._DummyThread)}

    once()
    before = own()
    once()
    assert own() <= before
