"""What bad peers send over Zenoh: the simulation continues, memory is bounded, each cause is logged once."""

import random
from pathlib import Path

import pytest
from conftest import rovers
from wires.ros_client import while_running
from wires.zenoh_peer import Heard, free_port, peer, tokens

from drake_twin.messages import message
from drake_twin.messages.interface_types import deserialize, make, serialize, type_hash
from drake_twin.services.graph import connect
from drake_twin.wires.rmw_zenoh_format import attachment, topic_key
from drake_twin.wires.zenoh_wire import ZenohWire

zenoh = pytest.importorskip("zenoh")
ext = pytest.importorskip("zenoh.ext")


COMMANDS, ARRAY = "/robot_1/forward_velocity_controller/commands", "std_msgs/msg/Float64MultiArray"
KEY = topic_key(0, COMMANDS, ARRAY, type_hash(ARRAY))
SWITCH, SWITCH_TYPE = "/robot_1/controller_manager/switch_controller", "controller_manager_msgs/srv/SwitchController"


@pytest.fixture
def port():
    return free_port()


@pytest.fixture
def twin(port):
    with rovers(1).build() as twin:
        seam = connect(twin, [ZenohWire(domain=0, port=port)])
        try:
            yield twin
        finally:
            seam.close()


def array(*values):
    return serialize(message(ARRAY, values))


def ask(session, data, service=SWITCH, kind=SWITCH_TYPE):
    key = topic_key(0, service, kind, type_hash(kind))
    (reply,) = session.get(key, payload=data, attachment=attachment(1, 1, bytes(16)), timeout=60.0)
    return deserialize(f"{kind}_Response", reply.ok.payload.to_bytes())


def good_command(session, value=1.5):
    """A command, and a request after it, so that it has been done once the answer is there."""
    session.put(KEY, array(*[value] * 4))
    assert ask(session, serialize(make(f"{SWITCH_TYPE}_Request", {}))).ok


def memory():
    """The resident memory of this process (MiB)."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 >> 20


def test_random_bytes_and_lengths_that_lie(twin, port, caplog):
    chance = random.Random(17)
    lying = b"\x00\x01\x00\x00" + b"\x00" * 8 + b"\xff\xff\xff\xff" + bytes(32)

    def send():
        with peer(port) as other:
            for _ in range(200):
                other.put(KEY, chance.randbytes(chance.randrange(64)))
                other.put(KEY, lying)
                assert not ask(other, b"\xff" * chance.randrange(1, 8)).ok
            good_command(other)

    before = twin.time
    while_running(twin, send)
    assert twin.time > before
    assert list(twin.graph.command(COMMANDS).data) == [1.5] * 4
    said = [record.getMessage() for record in caplog.records]
    assert len([text for text in said if text.startswith(f"{COMMANDS}: ")]) <= 3
    assert len([text for text in said if text.startswith(f"{SWITCH}: ")]) <= 2


def test_a_request_that_is_none_is_answered_with_the_reason(twin, port):
    with peer(port) as other:
        response = while_running(twin, lambda: ask(other, b"\x00\x01\x00\x00\xff"))
    assert not response.ok
    assert "5 bytes are not a controller_manager_msgs/srv/SwitchController_Request" in response.message


def test_a_message_of_100_megabytes(twin, port, caplog):
    def send():
        with peer(port) as other:
            before = memory()
            for _ in range(3):
                other.put(KEY, bytes(100 << 20), congestion_control=zenoh.CongestionControl.BLOCK)
            good_command(other)
            return memory() - before

    grown = while_running(twin, send)
    assert grown < 250  # what the peer and the twin, in this one process, keep for the next one
    assert list(twin.graph.command(COMMANDS).data) == [1.5] * 4
    (said,) = [record.getMessage() for record in caplog.records if record.getMessage().startswith(COMMANDS)]
    assert said == f"{COMMANDS}: a message of more than 1048576 bytes is ignored"


def test_a_flood_of_commands(twin, port):
    """20,000 commands as fast as they go: the newest counts, time goes on, and memory does not grow."""

    def send():
        with peer(port) as other:
            good_command(other)
            before = memory()
            for number in range(20_000):
                other.put(KEY, array(*[number / 1e4] * 4))
            good_command(other, 2.5)
            return memory() - before

    grown = while_running(twin, send)
    assert list(twin.graph.command(COMMANDS).data) == [2.5] * 4
    assert grown < 100
    assert twin.time > 0.1


def test_clients_that_leave_before_the_answer(twin, port):
    request = serialize(make(f"{SWITCH_TYPE}_Request", {}))
    key = topic_key(0, SWITCH, SWITCH_TYPE, type_hash(SWITCH_TYPE))

    def use():
        for _ in range(20):
            with peer(port) as other:
                other.get(key, Heard(), payload=request, attachment=attachment(1, 1, bytes(16)))
        with peer(port) as other:
            good_command(other)

    while_running(twin, use)
    assert list(twin.graph.command(COMMANDS).data) == [1.5] * 4


def test_open_wires_that_nobody_uses_change_no_bit(port):
    def state(is_connected):
        with rovers(2).build() as twin:
            twin.publish("/robot_2/forward_velocity_controller/commands", [2.0] * 4)
            seam = connect(twin, [ZenohWire(domain=0, port=port)]) if is_connected else None
            twin.advance_to(1.234)
            if seam is not None:
                seam.close()
            return twin.state_sha256()

    assert state(True) == state(False)


def test_a_type_without_a_hash_is_on_the_graph_as_humble_has_it(port, monkeypatch):
    def unknown(kind):
        raise ValueError(f"unknown type {kind!r}")

    monkeypatch.setattr("drake_twin.wires.seam.definition", unknown)
    monkeypatch.setattr(
        "drake_twin.wires.seam.type_hash", lambda kind: unknown(kind) if "/msg/" in kind else "RIHS01_0"
    )
    heard = Heard()
    with rovers(1).build() as twin:
        seam = connect(twin, [ZenohWire(domain=0, port=port)])
        try:
            with peer(port) as other:
                assert "sensor_msgs::msg::dds_::JointState_/TypeHashNotSupported/" in str(tokens(other))
                key = topic_key(0, "/robot_1/joint_states", "sensor_msgs/msg/JointState", "TypeHashNotSupported")
                other.declare_subscriber(key, heard)
                other.put(topic_key(0, COMMANDS, ARRAY, "RIHS01_7"), array(1.5, 1.5, 1.5, 1.5))
                while_running(twin, lambda: heard.wait_for(10))
        finally:
            seam.close()
        assert list(twin.graph.command(COMMANDS).data) == [1.5] * 4
