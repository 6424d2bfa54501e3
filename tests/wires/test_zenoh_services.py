"""Clients of services over Zenoh, of servers that nobody here wrote: zenoh-ros2-sdk's."""

import logging

import pytest
from conftest import rovers
from nodes.node_runs import HEAD, script
from waiting import until
from wires.ros_client import ros_client, while_running
from wires.zenoh_peer import Heard, free_port, peer, tokens

from drake_twin.messages.interface_types import deserialize, make, serialize, type_hash
from drake_twin.services.graph import connect
from drake_twin.wires.rmw_zenoh_format import read_token, topic_key
from drake_twin.wires.wire import WireEndpoint
from drake_twin.wires.zenoh_wire import ZenohWire

pytest.importorskip("zenoh")
pytest.importorskip("zenoh_ros2_sdk", reason="zenoh-ros2-sdk, an independent ROS 2 client, is not installed")

DOMAIN = 6
KIND = "example_interfaces/srv/AddTwoInts"
ADD = WireEndpoint("/elsewhere/add", KIND, type_hash(KIND), "/asking")

ASKING = f"""{HEAD}
from example_interfaces.srv import AddTwoInts

rclpy.init()
node = Node("asking")
client = node.create_client(AddTwoInts, "/elsewhere/add")
client.wait_for_service()
for number in range(3):
    future = client.call_async(AddTwoInts.Request(a=number, b=40))
    rclpy.spin_until_future_complete(node, future)
    with open(__file__ + ".said", "a") as file:
        print(future.result().sum, file=file)
"""


@pytest.fixture
def port():
    return free_port()


@pytest.fixture
def wire(port):
    wire = ZenohWire(domain=DOMAIN, port=port)
    try:
        yield wire
    finally:
        wire.close()


def serve(other):
    other.serve("/elsewhere/add", KIND, lambda asked: other.message(f"{KIND}_Response", sum=asked.a + asked.b))


def request(a, b):
    return serialize(make(f"{KIND}_Request", {"a": a, "b": b}))


def sums(answers):
    return [deserialize(f"{KIND}_Response", data).sum for data in answers]


def test_a_node_asks_a_service_of_another_program(tmp_path, port):
    node = script(tmp_path, "asking.py", ASKING)
    said = node.with_name(f"{node.name}.said")
    with rovers(1).node(node).build() as twin:
        seam = connect(twin, [ZenohWire(domain=DOMAIN, port=port)], twin.companions[0])
        try:
            with ros_client(port, DOMAIN) as other:
                serve(other)
                while_running(twin, lambda: until(lambda: said.exists() and said.read_text().count("\n") == 3))
        finally:
            seam.close()
    assert said.read_text().split() == ["40", "41", "42"]


def test_a_client_knows_whether_its_service_is_there(wire, port):
    changes, answers = Heard(), Heard()
    client = wire.client(ADD, lambda: changes(client.is_there))
    with peer(port) as other:
        (entity,) = (item for item in map(read_token, tokens(other)) if item and item.kind == "SC")
    assert (entity.node, entity.name, entity.type) == ("/asking", "/elsewhere/add", KIND)
    assert not client.is_there
    with ros_client(port, DOMAIN) as other:
        serve(other)
        assert changes.wait_for(1) == [True]
        for number in range(100):
            client.ask(request(number, 1), answers)
        assert sorted(sums(answers.wait_for(100))) == list(range(1, 101))
    assert changes.wait_for(2) == [True, False]
    client.close()
    with peer(port) as other:
        assert not [item for item in map(read_token, tokens(other)) if item and item.kind == "SC"]


def test_of_two_answers_the_first_counts_and_what_is_none_is_logged(wire, port, caplog):
    """A server that refuses, then answers without an attachment, then as a ROS node does, twice."""
    key, answers, asked = topic_key(DOMAIN, ADD.name, KIND, type_hash(KIND)), Heard(), Heard()
    client = wire.client(ADD, lambda: None)

    def answer(query):
        asked(query)
        total = serialize(make(f"{KIND}_Response", {"sum": 7}))
        query.reply_err("busy")
        query.reply(key, total)
        query.reply(key, total, attachment=query.attachment)
        query.reply(key, total, attachment=query.attachment)
        query.drop()

    def is_answered():
        client.ask(request(3, 4), answers)  # what is sent before they know each other is lost
        return bool(answers.items)

    with peer(port) as other, caplog.at_level(logging.WARNING):
        queryable = other.declare_queryable(key, answer, complete=True)
        until(is_answered)
        queryable.undeclare()
    assert sums(answers.items) == [7] * len(answers.items)
    assert len(answers.items) <= len(asked.items)
    assert "/elsewhere/add: a request is refused: busy" in caplog.messages
    assert "/elsewhere/add: a response is ignored: an attachment of 0 bytes, but rmw_zenoh's has 33" in caplog.messages
