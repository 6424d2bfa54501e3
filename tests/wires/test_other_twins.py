"""Two twins on one ROS domain: the second is refused in words, unless a domain or a namespace parts them."""

import os

import pytest
from conftest import rovers
from local_wire import LocalWire
from program_runs import run
from waiting import until
from wires.zenoh_peer import free_port

from drake_twin.errors import InputError
from drake_twin.run import main
from drake_twin.services.graph import connect
from drake_twin.wires.namespaced_wire import NamespacedWire
from drake_twin.wires.other_twins import refuse_other_twin
from drake_twin.wires.wire import WireEndpoint

DOMAIN = 140 + int(os.environ.get("PYTEST_XDIST_WORKER", "gw0")[2:])
TOPICS = ["/clock", "/robot_1/joint_states", "/tf", "/tf_static"]


class Beside:
    """A wire that sees another program."""

    def __init__(self, node, *topics):
        self.domain, self.node, self.topics = 7, node, topics

    def topics_beside(self, node):
        return self.topics if node == self.node else []


def test_what_both_would_publish_is_named():
    with pytest.raises(InputError) as caught:
        refuse_other_twin(Beside("/drake_twin", *reversed(TOPICS), "/own"), TOPICS)
    assert str(caught.value) == (
        "another twin is on ROS domain 7 and publishes /clock, /robot_1/joint_states, /tf and 1 more, which this one"
        " would publish as well: end that twin, or give this one a domain of its own with --ros-domain N, or names of"
        " its own with --ros-namespace NAME, which goes before its topics, services and nodes."
    )


@pytest.mark.parametrize(
    "other",
    [Beside("/robot_state_publisher", "/tf"), Beside("/drake_twin", "/a/clock"), Beside("/a/drake_twin", *TOPICS)],
)
def test_others_may_be_there(other):
    refuse_other_twin(other, TOPICS)


def test_a_namespace_goes_before_all_names():
    wire = LocalWire()
    wire.domain = 0
    named = NamespacedWire(wire, "/left")
    named.advertise(WireEndpoint("/tf", "tf2_msgs/msg/TFMessage", "", "/robot_state_publisher"), lambda is_heard: None)
    named.listen(WireEndpoint("/r/cmd_vel", "geometry_msgs/msg/Twist", "", "/r/drive"), lambda data: None)
    named.serve(WireEndpoint("/drake_twin/step", "std_srvs/srv/Trigger", "", "/drake_twin"), lambda data, reply: None)
    assert wire.senders["/left/tf"].topic.node == "/left/robot_state_publisher"
    assert wire.listeners["/left/r/cmd_vel"].endpoint.node == "/left/r/drive"
    assert wire.services["/left/drake_twin/step"].endpoint.node == "/left/drake_twin"
    assert not named.client(WireEndpoint("/add", "std_srvs/srv/Trigger", "", "/asker"), lambda: None).is_there
    wire.client = lambda service, changed: service  # as a wire over which others can be asked
    asked = named.client(WireEndpoint("/add", "std_srvs/srv/Trigger", "", "/asker"), lambda: None)
    assert (asked.name, asked.node) == ("/left/add", "/left/asker")
    beside = NamespacedWire(Beside("/left/drake_twin", "/left/clock", "/tf"), "/left")
    assert beside.topics_beside("/drake_twin") == ["/clock", "/tf"]


def dds(domain, port):
    pytest.importorskip("cyclonedds", reason="cyclonedds is not installed")
    from drake_twin.wires.dds_wire import DdsWire

    return DdsWire(domain)


def zenoh(domain, port):
    pytest.importorskip("zenoh", reason="zenoh is not installed")
    from drake_twin.wires.zenoh_wire import ZenohWire

    return ZenohWire(domain, port=port)


@pytest.mark.parametrize("transport", [dds, zenoh])
def test_a_second_twin_is_refused_and_both_work_in_a_namespace_or_a_domain_of_their_own(transport):
    port = free_port()
    seam = connect(rovers(1).build(), [transport(DOMAIN, port)])
    ros = ["--ros", transport.__name__, "--ros-domain", DOMAIN]
    ros += ["--ros-port", port] if transport is zenoh else []
    try:
        second = run("--robots", 1, "--headless", "--duration", 0.01, *ros)
        assert second.returncode == 2
        assert f"error: another twin is on ROS domain {DOMAIN} and publishes " in second.stderr
        assert "Traceback" not in second.stderr
        second = run("--robots", 1, "--headless", "--duration", 0.01, *ros, "--ros-namespace", "second")
        assert (second.returncode, "another twin" in second.stderr) == (0, False)
        other = transport(DOMAIN + 40, port)
        assert other.topics_beside("/drake_twin") == []
        other.close()
    finally:
        seam.close()


def test_a_robot_state_publisher_of_the_users_own_is_no_twin():
    pytest.importorskip("cyclonedds", reason="cyclonedds is not installed")
    from cyclonedds.core import Qos
    from cyclonedds.domain import DomainParticipant

    from drake_twin.wires.dds_endpoints import quality, writer
    from drake_twin.wires.dds_wire import DdsWire
    from drake_twin.wires.rmw_dds_format import GRAPH_TOPIC, GRAPH_TYPE, NodeEndpoints, graph_message, sample_type

    wire = DdsWire(DOMAIN)
    participant = DomainParticipant(DOMAIN, Qos())
    tf = writer(participant, "rt/tf", "tf2_msgs/msg/TFMessage", quality(b""))
    graph = writer(participant, GRAPH_TOPIC, GRAPH_TYPE, quality(b"", latched=True, depth=1))
    gid, writers = participant.guid.bytes, NodeEndpoints((), (tf.guid.bytes,))
    try:
        for names, others in (
            (("/robot_state_publisher", "/other/drake_twin"), {"/drake_twin", "/drake"}),
            (("/robot_state_publisher", "/drake_twin"), {"/other/drake_twin"}),
        ):
            graph.write(sample_type(GRAPH_TYPE)(graph_message(gid, dict.fromkeys(names, writers))))
            for name in names:
                until(lambda name=name: wire.topics_beside(name) == ["/tf"])
            assert [wire.topics_beside(name) for name in others] == [[]] * len(others)
        del tf, graph, participant
        until(lambda: not wire.topics_beside("/drake_twin"))
    finally:
        wire.close()


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        (["--ros", "dds", "--ros-domain", "233"], "--ros-domain 233: a ROS domain is from 0 to 232"),
        (["--ros", "dds", "--ros-namespace", "a b"], "--ros-namespace a b: it is not a namespace"),
        (["--ros", "dds", "--ros-namespace", "/"], "--ros-namespace /: it is not a namespace"),
        (["--ros-domain", "0"], "--ros-domain is about the ROS 2 graph: it needs --ros."),
        (["--ros-namespace", "a"], "--ros-namespace is about the ROS 2 graph: it needs --ros."),
    ],
)
def test_options_that_cannot_be_used_are_refused(options, problem, capsys):
    assert main(["--robots", "1", "--headless", "--duration", "0.01", *options]) == 2
    assert problem in capsys.readouterr().err
