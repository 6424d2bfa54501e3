"""The connection graph in Foxglove, against its own client."""

import pytest
from conftest import ROVER, rovers
from wires.foxglove_client import foxglove_client
from wires.ros_client import while_running

from drake_twin.scenario import Robot
from drake_twin.services.graph import connect
from drake_twin.wires.foxglove_graph import FoxgloveGraph
from drake_twin.wires.foxglove_wire import FoxgloveWire
from drake_twin.wires.wire import WireEndpoint

pytest.importorskip("foxglove")


def graph_of(events):
    """The graph that the updates add up to: which nodes publish, hear and serve."""
    parts = {"published": {}, "subscribed": {}, "served": {}}
    for item in events:
        if item["event"] == "graph":
            parts["published"] |= {topic["name"]: topic["publisherIds"] for topic in item["publishedTopics"]}
            parts["subscribed"] |= {topic["name"]: topic["subscriberIds"] for topic in item["subscribedTopics"]}
            parts["served"] |= {service["name"]: service["providerIds"] for service in item["advertisedServices"]}
            for name in item["removedTopics"]:
                parts["published"].pop(name, None)
                parts["subscribed"].pop(name, None)
            for name in item["removedServices"]:
                parts["served"].pop(name, None)
    return parts


def test_a_client_sees_the_nodes_of_what_is_published_heard_and_served():
    with rovers(2).build() as twin:
        wire = FoxgloveWire(port=0)
        seam = connect(twin, [wire])

        def watch(has):
            return lambda peer: peer.wait_for(lambda events: has(graph_of(events)) and graph_of(events))

        with foxglove_client(wire.port) as peer:
            peer.first("serverInfo")
            peer.do("watchGraph")
            found = while_running(twin, lambda: watch(lambda graph: graph["published"])(peer))
            assert found["published"]["/robot_2/joint_states"] == ["/robot_2/joint_state_broadcaster"]
            commands = "/robot_1/forward_velocity_controller/commands"
            assert found["subscribed"][commands] == ["/robot_1/forward_velocity_controller"]
            assert found["served"]["/robot_1/controller_manager/list_controllers"] == ["/robot_1/controller_manager"]
            twin.entities.spawn(Robot("late", ROVER, xyz=(0, 5, 0)))
            while_running(twin, lambda: watch(lambda graph: "/late/joint_states" in graph["published"])(peer))
            twin.entities.delete("late")
            gone = while_running(
                twin, lambda: watch(lambda graph: "/late/joint_states" not in graph["published"])(peer)
            )
            assert not any(name.startswith("/late/") for part in gone.values() for name in part)
        seam.close()


def test_what_nobody_watches_starts_no_thread(monkeypatch):
    monkeypatch.setattr("drake_twin.wires.foxglove_graph.threading.Timer", None)
    graph = FoxgloveGraph(lambda graph: None)
    for kind in ("published_topic", "subscribed_topic", "advertised_service"):
        graph.add(kind, WireEndpoint("/x", "std_msgs/msg/Bool", "", "/n"))
    graph.close()
