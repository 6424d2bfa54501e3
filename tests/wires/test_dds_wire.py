"""The graph over DDS: its formats, and a running twin against eProsima Fast DDS."""

import logging
import os
import threading
from dataclasses import dataclass
from itertools import pairwise

import pytest
from conftest import ROVER, rovers
from rosbags.typesys import Stores, get_typestore
from waiting import until
from wires.fast_dds_peer import fast_dds_peer
from wires.ros_client import while_running

from drake_twin import Robot
from drake_twin.errors import InputError
from drake_twin.messages import float64_multi_array
from drake_twin.messages.interface_types import deserialize, make, serialize
from drake_twin.services.graph import connect
from drake_twin.twin.replay import replay
from drake_twin.wires.dds_endpoints import quality, reader, writer
from drake_twin.wires.dds_wire import DdsWire
from drake_twin.wires.rmw_dds_format import (
    GRAPH_TYPE,
    NodeEndpoints,
    endpoint_data,
    graph_message,
    sample_type,
    topic_name,
)
from drake_twin.wires.ros_names import dds_type
from drake_twin.wires.wire import WireEndpoint

pytest.importorskip("cyclonedds", reason="cyclonedds is not installed")

JAZZY = get_typestore(Stores.ROS2_JAZZY)
DOMAIN = 100 + int(os.environ.get("PYTEST_XDIST_WORKER", "gw0")[2:])
STATES, COMMANDS = "/robot_1/joint_states", "/robot_1/forward_velocity_controller/commands"
STATE, ARRAY, STRING = (
    dds_type(f"{name}")
    for name in ("sensor_msgs/msg/JointState", "std_msgs/msg/Float64MultiArray", "std_msgs/msg/String")
)


@pytest.fixture
def twin():
    with rovers(2).build() as twin:
        seam = connect(twin, [DdsWire(DOMAIN)])
        try:
            yield twin
        finally:
            seam.close()


def states(peer, count):
    found = [JAZZY.deserialize_cdr(data, "sensor_msgs/msg/JointState") for data in peer.messages(count, STATES)]
    return [message.header.stamp.sec * 10**9 + message.header.stamp.nanosec for message in found]


def test_names_and_user_data():
    """As in ROS 2's "Topic and Service name mapping to DDS", and rmw_dds_common's qos.hpp."""
    assert topic_name("/robot_1/joint_states") == "rt/robot_1/joint_states"
    assert endpoint_data("RIHS01_ab") == b"typehash=RIHS01_ab;"
    assert endpoint_data("") == b""


def test_the_graphs_bytes_are_those_of_cyclonedds_own_serializer():
    from cyclonedds.idl import IdlStruct
    from cyclonedds.idl.types import array, bounded_str, sequence, uint8

    @dataclass
    class Gid(IdlStruct, typename="Gid"):
        data: array[uint8, 16]

    @dataclass
    class Node(IdlStruct, typename="Node"):
        node_namespace: bounded_str[256]
        node_name: bounded_str[256]
        reader_gid_seq: sequence[Gid]
        writer_gid_seq: sequence[Gid]

    @dataclass
    class Info(IdlStruct, typename="Info"):
        gid: Gid
        node_entities_info_seq: sequence[Node]

    first, second, third = (bytes(range(start, start + 16)) for start in (0, 16, 32))
    nodes = [Node("/robot_1", "tf", [Gid([*second])], [Gid([*third]), Gid([*first])]), Node("/", "clock", [], [])]
    expected = Info(Gid([*first]), nodes)
    found = graph_message(first, {"/robot_1/tf": NodeEndpoints((second,), (third, first)), "/clock": NodeEndpoints()})
    assert found == expected.serialize(use_version_2=False)


def test_joint_states_come_without_a_gap(twin):
    with fast_dds_peer(DOMAIN) as peer:

        def work():
            peer.subscribe(STATES, STATE)
            return states(peer, 201)

        stamps = while_running(twin, work)
    assert {after - before for before, after in pairwise(stamps[1:])} == {10_000_000}


def test_a_late_joiner_gets_the_description(twin):
    twin.advance_to(0.3)
    topic = "/robot_1/robot_description"
    with fast_dds_peer(DOMAIN) as peer:
        peer.subscribe(topic, STRING, "latched")
        (data,) = peer.messages(1, topic)
    assert JAZZY.deserialize_cdr(data, "std_msgs/msg/String").data == twin.latest(topic).data


def test_the_graph_names_the_nodes_and_their_endpoints(twin):
    with fast_dds_peer(DOMAIN) as peer:
        peer.do(f"sub ros_discovery_info {dds_type(GRAPH_TYPE)} latched")
        data = bytes.fromhex(peer.wait(1, "heard", "ros_discovery_info")[-1][2])
        writers = {line[1]: line for line in peer.wait(len(twin.graph.topics()) - 2, "writer")}
        (reader,) = peer.wait(1, "reader", f"rt{COMMANDS}")
    message = JAZZY.deserialize_cdr(data, GRAPH_TYPE)
    nodes = {f"{node.node_namespace.rstrip('/')}/{node.node_name}": node for node in message.node_entities_info_seq}
    assert {"/robot_1/robot_state_publisher", "/robot_1/joint_state_broadcaster"} <= nodes.keys()
    assert {"/robot_2/forward_velocity_controller", "/drake_twin", "/robot_1/controller_manager"} <= nodes.keys()
    _, _, kind, user_data, guid = writers[f"rt{STATES}"]
    assert (kind, user_data) == (STATE, f"typehash={_hash('sensor_msgs/msg/JointState')};")
    gids = [bytes(gid.data.tolist()).hex() for gid in nodes["/robot_1/joint_state_broadcaster"].writer_gid_seq]
    assert guid in gids
    readers = nodes["/robot_1/forward_velocity_controller"].reader_gid_seq
    assert reader[4] in [bytes(gid.data.tolist()).hex() for gid in readers]


def _hash(kind):
    return JAZZY.hash_rihs01(kind)


def test_commands_are_recorded_and_replayed(twin):
    twin.recorder.begin()
    with fast_dds_peer(DOMAIN) as peer:

        def work():
            peer.subscribe(STATES, STATE)
            states(peer, 10)
            for _ in range(10):  # the first may come before the twin's reader knows the writer
                peer.publish(COMMANDS, ARRAY, serialize(float64_multi_array([3.0] * 4)))
                states(peer, len(states(peer, 1)) + 10)

        while_running(twin, work)
    assert list(twin.graph.command(COMMANDS).data) == [3.0] * 4
    assert twin.robot_state("robot_1").base_pose[0] > 0.005
    with replay(twin.recorder.recording()) as again:
        assert again.state_sha256() == twin.state_sha256()


def test_nobody_listens_and_nothing_is_evaluated(twin):
    with fast_dds_peer(DOMAIN) as peer:
        peer.wait(1, "writer", f"rt{STATES}")
        twin.advance_to(0.2)
        assert all(item.is_latched for item in twin._session.subscriptions._items)
        while_running(twin, lambda: (peer.subscribe(STATES, STATE), states(peer, 3)))
        assert not all(item.is_latched for item in twin._session.subscriptions._items)


def test_the_same_run_with_and_without_has_the_same_state(twin):
    with rovers(2).build() as alone:
        twin.advance_to(0.5)
        alone.advance_to(0.5)
        assert twin.state_sha256() == alone.state_sha256()


def test_spawns_and_deletes_leave_nothing(twin):
    """Of twenty robots that come and go no writer, reader or thread is left."""
    before = set(threading.enumerate())
    wire = twin.inbox.looks[0].__self__._wires[0]
    counts = len(wire._senders), len(wire._readings)
    for _ in range(20):
        twin.entities.spawn(Robot("guest", ROVER, xyz=(0, -3, 0.13)))
        twin.advance_to(twin.time + 0.02)
        assert len(wire._senders) > counts[0]
        twin.entities.delete("guest")
        twin.advance_to(twin.time + 0.02)
    assert (len(wire._senders), len(wire._readings)) == counts
    assert set(threading.enumerate()) == before


def test_bytes_that_are_no_message_are_one_line_of_the_log(twin, caplog):
    with fast_dds_peer(DOMAIN) as peer, caplog.at_level(logging.WARNING):

        def work():
            peer.subscribe(STATES, STATE)
            for data in (
                b"\0\1\0\0" + b"\xff" * 40,
                b"\0",
                b"\0\1\0\0" + os.urandom(100),
                b"\0\1\0\0" + bytes(2 << 20),
            ):
                peer.publish(COMMANDS, ARRAY, data)
            states(peer, len(states(peer, 1)) + 20)

        while_running(twin, work)
    lines = {line for line in caplog.messages if line.startswith(COMMANDS)}
    assert len(lines) <= 3
    assert len([line for line in caplog.messages if line.startswith(COMMANDS)]) == len(lines)
    assert twin.graph.command(COMMANDS) is None


def test_a_peer_that_stops_to_read_does_not_stop_the_simulation(twin):
    with fast_dds_peer(DOMAIN) as peer:
        while_running(twin, lambda: (peer.subscribe(STATES, STATE), states(peer, 5)))
        peer.stop_reading()
        start = twin.time
        twin.advance_to(start + 5.0)
        assert twin.time == pytest.approx(start + 5.0)


def test_an_address_that_is_not_here():
    with pytest.raises(InputError, match=r"domain 3 cannot be opened on 203\.0\.113\.5"):
        DdsWire(3, "203.0.113.5")


def test_a_message_of_another_participant_is_heard_while_its_end_is_open(monkeypatch):
    from cyclonedds.core import Qos
    from cyclonedds.domain import DomainParticipant

    monkeypatch.setattr("waiting.LONGEST", 30)  # it comes at the next change of the graph anyway
    kind, heard = "std_msgs/msg/String", []
    wire = DdsWire(DOMAIN)
    listener = wire.listen(WireEndpoint("/chatter", kind, "", "/node"), heard.append)
    talkers = [writer(DomainParticipant(DOMAIN, Qos()), topic_name("/chatter"), kind, quality(b""))]
    try:
        until(lambda: talkers[0].get_matched_subscriptions())
        talkers[0].write(sample_type(kind)(serialize(make(kind, {"data": "hello"}))))
        until(lambda: heard)
        assert [deserialize(kind, data).data for data in heard] == ["hello"]
        listener.close()
        until(lambda: not talkers[0].get_matched_subscriptions())
    finally:
        talkers.clear()
        wire.close()


@pytest.mark.parametrize(
    ("offered", "requested"),
    [
        ({}, {"deadline": 0.5}),
        ({"deadline": 0.5}, {"deadline": 0.2}),
        ({}, {"is_manual": True}),
        ({"lease": 2.0}, {"lease": 1.0}),
        ({"is_best_effort": True}, {}),
    ],
)
def test_who_offers_less_than_is_requested_is_not_heard(offered, requested):
    """As between two nodes of ROS: DDS's RxO rules (OMG DDS 1.4, 2.2.3)."""
    from cyclonedds.core import Qos
    from cyclonedds.domain import DomainParticipant

    kind, told, readers, wire = "std_msgs/msg/String", [], [], DdsWire(DOMAIN)
    listener = DomainParticipant(DOMAIN, Qos())
    try:
        for name, more in (("/less", offered), ("/same", requested)):
            topic = WireEndpoint(name, kind, "", "/talker", **more)
            wire.advertise(topic, lambda is_heard, name=name: told.append(name))
            readers.append(reader(listener, topic_name(name), kind, quality(b"", **requested)))
        until(lambda: told)
    finally:
        readers.clear()
        wire.close()
    assert set(told) == {"/same"}


def test_the_ends_of_a_closed_wire_send_nothing_and_can_be_closed():
    wire, kind = DdsWire(DOMAIN), "std_msgs/msg/String"
    sender = wire.advertise(WireEndpoint("/said", kind, "", "/node"), lambda is_heard: None)
    listener = wire.listen(WireEndpoint("/heard", kind, "", "/node"), lambda data: None)
    server = wire.serve(WireEndpoint("/do", "std_srvs/srv/Trigger", "", "/node"), lambda data, reply: None)
    client = wire.client(WireEndpoint("/done", "std_srvs/srv/Trigger", "", "/node"), lambda: None)
    wire.close()
    sender.send(serialize(make(kind, {"data": "late"})), 0)
    for end in (sender, listener, server, client):
        end.close()


def test_a_listener_that_comes_while_listeners_are_counted():
    """CycloneDDS's Python counts them, makes a list of that length, and reads into it: here one more comes between."""
    counted = []

    def count(entity, handles, most):
        counted.append(most)
        return 1 if len(counted) == 1 else 2

    wire, told = DdsWire(DOMAIN), []
    try:
        sender = wire.advertise(WireEndpoint("/text", "std_msgs/msg/String", "RIHS01_0", "/node"), told.append)
        sender._writer._get_matched_subscriptions = count
        sender.look()
    finally:
        wire.close()
    assert counted[:4] == [0, 1, 0, 2]
    assert told == [True]
