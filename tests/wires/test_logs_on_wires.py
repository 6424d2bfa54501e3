"""Lines of logs on the wires: with rcl's quality of service, and the last ones for who comes late."""

import logging
import os

import pytest
from conftest import rovers
from nodes.node_runs import script
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore
from waiting import until
from wires.local_wire import LocalWire
from wires.ros_client import while_running

from drake_twin.messages.interface_types import deserialize, make, serialize, type_hash
from drake_twin.services.graph import connect
from drake_twin.wires.bag_wire import BagWire
from drake_twin.wires.rmw_zenoh_format import Qos
from drake_twin.wires.wire import WireEndpoint

JAZZY = get_typestore(Stores.ROS2_JAZZY)
LOG = "rcl_interfaces/msg/Log"
DOMAIN = 100 + int(os.environ.get("PYTEST_XDIST_WORKER", "gw0")[2:])
NODE = """
class My(Node):
    def __init__(self):
        super().__init__("talker")
        self.get_logger().info("born")
        self.get_logger().error("soon after")
"""


@pytest.fixture
def twin(tmp_path):
    with rovers(1).node(script(tmp_path, "node.py", NODE)).build() as twin:
        yield twin


def connected(twin, wire):
    return connect(twin, [wire], twin.companions[0])


def lines(data):
    found = [JAZZY.deserialize_cdr(item, LOG) for item in data]
    return [(line.name, line.level, line.msg) for line in found]


WANTED = [("talker", 20, "born"), ("talker", 40, "soon after")]


def test_a_wire_gets_them_with_the_quality_of_service_of_rcl(twin):
    wire = LocalWire()
    seam = connected(twin, wire)
    twin.advance_to(0.1)
    seam.flush()
    sender = wire.senders["/rosout"]
    assert lines(data for data, _ in sender.sent) == WANTED
    topic = sender.topic
    assert (topic.latched, topic.kept, topic.lifespan, topic.is_best_effort) == (True, 1000, 10.0, False)
    assert not wire.senders["/parameter_events"].topic.latched
    assert wire.senders["/parameter_events"].topic.kept == 1000
    seam.close()


def test_a_bag_has_them_with_their_profile(twin, tmp_path):
    seam = connected(twin, BagWire(tmp_path / "bag"))
    twin.advance_to(0.1)
    seam.close()
    with AnyReader([tmp_path / "bag"]) as reader:
        (connection,) = [item for item in reader.connections if item.topic == "/rosout"]
        assert lines(data for _, _, data in reader.messages([connection])) == WANTED
        (profile,) = connection.ext.offered_qos_profiles
    assert (profile.depth, profile.durability.name) == (1000, "TRANSIENT_LOCAL")
    assert (profile.lifespan.sec, profile.lifespan.nsec) == (10, 0)


@pytest.fixture
def dds():
    """A wire, and another participant on its domain."""
    pytest.importorskip("cyclonedds", reason="cyclonedds is not installed")
    from cyclonedds.domain import DomainParticipant

    from drake_twin.wires.dds_wire import DdsWire

    wire = DdsWire(DOMAIN)
    yield wire, DomainParticipant(DOMAIN)
    wire.close()


def subscribed(participant, topic, depth):
    from drake_twin.wires.dds_endpoints import quality, reader

    return reader(participant, f"rt{topic}", LOG, quality(b"", latched=True, depth=depth))[0]


def test_over_dds_they_come_with_the_lifespan_of_rcl(twin, dds):
    from cyclonedds.core import Policy

    wire, other = dds
    heard = subscribed(other, "/rosout", 10)
    seam = connected(twin, wire)
    (matched,) = until(heard.get_matched_publications)
    assert Policy.Lifespan(10 * 10**9) in heard.get_matched_publication_data(matched).qos
    twin.advance_to(0.1)
    found = []
    until(lambda: found.extend(sample.data for sample in heard.take(10)) or len(found) == 2)
    assert lines(found) == WANTED
    seam.close()


def test_a_late_joiner_over_dds_gets_as_many_as_the_topic_keeps(dds):
    """Of a topic without a lifespan, which may end before a slow reader is there."""
    wire, other = dds
    topic = WireEndpoint("/log", LOG, type_hash(LOG), "/n", latched=True, depth=3)
    sender = wire.advertise(topic, lambda is_heard: None)
    for name in "abcd":
        sender.send(serialize(make(LOG, {"name": name})), 0)
    heard, found = subscribed(other, "/log", 10), []
    until(lambda: found.extend(sample.data for sample in heard.take(10)) or len(found) == 3)
    assert [name for name, *_ in lines(found)] == ["b", "c", "d"]


def test_zenohs_token_tells_depth_and_lifespan():
    """As rmw_zenoh's liveliness_utils.cpp reads it: seconds and nanoseconds of the lifespan after the deadline's."""
    assert str(Qos(transient_local=True, depth=1000, lifespan=10 * 10**9)) == "1:1:1,1000:,:10,0:,,"
    assert str(Qos()) == "1:2:1,10:,:,:,,"


def test_a_late_joiner_over_zenoh_gets_them_all(twin):
    pytest.importorskip("zenoh", reason="zenoh is not installed")
    from wires.zenoh_peer import free_port

    from drake_twin.client import Client
    from drake_twin.wires.zenoh_wire import ZenohWire

    port = free_port()
    seam = connected(twin, ZenohWire(domain=DOMAIN, port=port))
    twin.advance_to(0.1)
    try:
        with Client(f"127.0.0.1:{port}", domain=DOMAIN) as client:
            found = []

            def both():
                client.subscribe("/rosout", found.append, is_raw=True)
                while len(found) < 2:
                    pass
                return found

            assert lines(while_running(twin, both)) == WANTED
    finally:
        seam.close()


def test_clients_of_foxglove_get_new_ones_and_only_the_first_what_was_before(twin):
    """What one client has got would come again otherwise: there is one channel for all."""
    pytest.importorskip("foxglove", reason="foxglove-sdk is not installed")
    from wires.foxglove_peer import foxglove_peer, messages_of

    from drake_twin.wires.foxglove_wire import FoxgloveWire

    wire = FoxgloveWire(port=0)
    seam = connected(twin, wire)
    twin.advance_to(0.1)

    def got(client):
        return [line.msg for line in messages_of(client, "/rosout", lambda data: deserialize(LOG, data))]

    def join(client, *, count):
        client.subscribe("/rosout")
        client.subscribe("/clock")
        client.wait("message", topic="/clock")
        client.wait("message", count, topic="/rosout")

    with foxglove_peer(wire.place) as first, foxglove_peer(wire.place) as second:
        while_running(twin, lambda: join(first, count=2))
        assert got(first) == ["born", "soon after"]
        while_running(twin, lambda: join(second, count=0))
        logging.getLogger("drake_twin.test").warning("for both")
        while_running(
            twin,
            lambda: [client.wait("message", count, topic="/rosout") for client, count in ((first, 3), (second, 1))],
        )
        assert (got(first), got(second)) == (["born", "soon after", "for both"], ["for both"])
    seam.close()


OF_ALL = {"/rosout", "/parameter_events"}


def test_over_zenoh_each_node_has_them_as_long_as_it_is_there(twin):
    pytest.importorskip("zenoh", reason="zenoh is not installed")
    from wires.zenoh_peer import free_port

    from drake_twin.client import Client
    from drake_twin.wires.zenoh_wire import ZenohWire

    port = free_port()
    seam = connected(twin, ZenohWire(domain=DOMAIN, port=port))
    try:
        with Client(f"127.0.0.1:{port}", domain=DOMAIN) as client:
            for is_there in (False, True, False):
                entities = client.entities()
                nodes = {item.node for item in entities if item.kind == "NN"}
                assert ("/talker" in nodes) == is_there
                for topic in OF_ALL:
                    assert sorted(item.node for item in entities if item.name == topic) == sorted(nodes)
                if is_there:
                    twin.companions[0].close()
                twin.advance_to(twin.time + 0.1)
                twin.advance_to(twin.time + 0.1)
    finally:
        seam.close()


def test_over_dds_each_node_has_them(twin, dds):
    from drake_twin.wires.dds_endpoints import quality, reader
    from drake_twin.wires.rmw_dds_format import GRAPH_TOPIC, GRAPH_TYPE

    wire, other = dds
    seam = connected(twin, wire)
    graph, _ = reader(other, GRAPH_TOPIC, GRAPH_TYPE, quality(b"", latched=True, depth=1))
    twin.advance_to(0.1)
    twin.advance_to(0.2)
    found = {}

    def has_talker():
        for sample in graph.take(10):
            nodes = JAZZY.deserialize_cdr(sample.data, GRAPH_TYPE).node_entities_info_seq
            found.update({item.node_name: {bytes(gid.data) for gid in item.writer_gid_seq} for item in nodes})
        return "talker" in found

    until(has_talker)
    assert len(found) > 3
    assert len(set.intersection(*found.values())) == len(OF_ALL)
    seam.close()
