"""Services and actions over DDS in rmw_cyclonedds_cpp's mapping, against a client that shares no code with them."""

import logging
import os
import threading

import pytest
from conftest import ROVER, rovers
from nodes.node_runs import HEAD, script
from waiting import until
from wires.ros_client import while_running
from wires.ros_dds_client import dds_peer

from drake_twin import Robot
from drake_twin.messages.interface_types import deserialize, type_hash
from drake_twin.services.graph import connect
from drake_twin.wires.dds_service import DdsServer
from drake_twin.wires.dds_wire import DdsWire
from drake_twin.wires.rmw_dds_format import (
    endpoint_data,
    read_endpoint_data,
    request_topic,
    response_topic,
    service_id,
    with_header,
    without_header,
)

pytest.importorskip("cyclonedds", reason="cyclonedds is not installed")

DOMAIN = 120 + int(os.environ.get("PYTEST_XDIST_WORKER", "gw0")[2:])
LIST = "/robot_1/robot_state_publisher/list_parameters"
NAMES = ["use_sim_time", "robot_description", "publish_frequency", "frame_prefix", "ignore_timestamp"]
STEPS = "/drake_twin/simulate_steps/_action"


@pytest.fixture
def twin():
    with rovers(1).build() as twin:
        seam = connect(twin, [DdsWire(DOMAIN)])
        try:
            yield twin
        finally:
            seam.close()


def wire_of(twin):
    return twin.inbox.looks[0].__self__._wires[0]


def is_heard(twin, topic):
    return any(sender.is_heard for sender in wire_of(twin)._senders if sender.topic.name == topic)


def test_names_and_user_data():
    """As in ROS 2's "Topic and Service name mapping to DDS", and rmw_cyclonedds_cpp's csid_to_string."""
    assert request_topic("/robot_1/controller_manager/list_controllers") == (
        "rq/robot_1/controller_manager/list_controllersRequest"
    )
    assert response_topic("/add") == "rr/addReply"
    name = service_id(bytes.fromhex("0110a1b2c3d4e5f60718293a000001c1"), 258)
    assert name == "1.10.a1.b2.c3.d4.e5.f6.7.18.29.3a.0.0.1.2"
    data = endpoint_data("RIHS01_ab", serviceid=name)
    assert data == f"serviceid={name};typehash=RIHS01_ab;".encode()
    assert read_endpoint_data(data) == {"serviceid": name, "typehash": "RIHS01_ab"}
    assert read_endpoint_data(b"\xff\0;;=") == {}


def test_what_a_real_client_sent():
    """Recorded of rcl 9.2 with rmw_cyclonedds_cpp: the second request of a client of ``list_parameters``."""
    data = bytes.fromhex("00010000708a2e206e3196cf0200000000000000") + bytes(16)
    client, number, request = without_header(data)
    assert (client, number) == (0xCF96316E202E8A70, 2)
    assert request == b"\0\1\0\0" + bytes(16)
    found = deserialize("rcl_interfaces/srv/ListParameters_Request", request)
    assert (found.prefixes, found.depth) == ([], 0)
    told = read_endpoint_data(
        b"clientid= 1.10.71.90.fa.6b.f7.1.d3.fc.3a.bc.0.0.0.1;"
        b"typehash=RIHS01_a1b0b5d6b967a5b8ac5bc8563c3ea678f349e312a6a4967227c5a96bc5ce38df;"
    )
    assert told["clientid"] == " 1.10.71.90.fa.6b.f7.1.d3.fc.3a.bc.0.0.0.1"
    assert told["typehash"] == type_hash("rcl_interfaces/srv/ListParameters_Request")


def test_a_header_of_either_byte_order():
    little = bytes.fromhex("00010000 0807060504030201 0200000000000000 2a00000000000000".replace(" ", ""))
    assert without_header(little) == (0x0102030405060708, 2, little[:4] + little[20:])
    assert with_header(0x0102030405060708, 2, little[:4] + little[20:]) == little
    big = bytes.fromhex("00000000 0102030405060708 0000000000000002 000000000000002a".replace(" ", ""))
    assert without_header(big) == (0x0102030405060708, 2, big[:4] + big[20:])
    with pytest.raises(ValueError, match="19 bytes are too few"):
        without_header(little[:19])


def test_parallel_clients_get_their_own_answers(twin):
    """Three processes with two clients each, 50 calls a client."""
    with dds_peer(DOMAIN) as first, dds_peer(DOMAIN) as second, dds_peer(DOMAIN) as third:

        def work():
            found = []

            def ask(peer):
                for name in ("a", "b"):
                    peer.client(name, LIST, "ListParameters")
                found.extend(peer.names(name, 50) for name in ("a", "b"))

            threads = [threading.Thread(target=ask, args=(peer,)) for peer in (first, second, third)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            return found

        assert while_running(twin, work) == [[NAMES]] * 6


@pytest.mark.slow
def test_ten_thousand_calls(twin):
    with dds_peer(DOMAIN) as peer:

        def work():
            peer.client("a", LIST, "ListParameters")
            return peer.names("a", 10_000)

        assert while_running(twin, work) == [NAMES]


def test_many_requests_at_once_are_all_answered(twin):
    with dds_peer(DOMAIN) as peer:

        def work():
            peer.client("a", LIST, "ListParameters")
            numbers = [peer.ask("a", [], 0) for _ in range(300)]
            return numbers, peer.answers("a", 300)

        numbers, answers = while_running(twin, work)
    assert sorted(answer["seq_"] for answer in answers) == numbers
    assert all(answer["result"]["names"] == NAMES for answer in answers)


def test_a_response_waits_for_its_clients_reader(twin):
    with dds_peer(DOMAIN) as peer:

        def work():
            peer.client("late", LIST, "ListParameters", is_deaf=True)
            peer.client("other", LIST, "ListParameters")
            peer.ask("late", [], 0)
            peer.call("other", [], 0)  # by now the first one's response would have been written, too
            peer.listen("late")
            return peer.answers("late", 1)

        (answer,) = while_running(twin, work)
    assert answer["result"]["names"] == NAMES


def test_an_action_from_its_goal_to_its_result(twin):
    twin.pause()
    start, number = twin.time, [[7] * 16]
    with dds_peer(DOMAIN) as peer:

        def work():
            peer.client("send", f"{STEPS}/send_goal", "SendGoal")
            peer.client("result", f"{STEPS}/get_result", "GetResult")
            peer.subscribe(f"{STEPS}/feedback", "FeedbackMessage")
            until(lambda: is_heard(twin, f"{STEPS}/feedback"))  # the twin's writer knows the reader later than this
            sent = peer.call("send", number, [400])
            result = peer.call("result", number)
            return sent, result, peer.heard(f"{STEPS}/feedback")

        sent, result, feedback = while_running(twin, work)
    assert sent["accepted"]
    assert (result["status"], result["result"]["result"]["result"]) == (4, 1)  # succeeded; RESULT_OK
    assert round((twin.time - start) / twin.clock.time_step) == 400
    assert {item["goal_id"]["uuid"][0] for item in feedback} == {7}
    assert all(sum(item["feedback"].values()) == 400 for item in feedback)


def test_a_goal_is_cancelled(twin):
    twin.pause()
    number = [[7] * 16]
    with dds_peer(DOMAIN) as peer:

        def work():
            peer.client("send", f"{STEPS}/send_goal", "SendGoal")
            peer.client("cancel", f"{STEPS}/cancel_goal", "CancelGoal")
            peer.client("result", f"{STEPS}/get_result", "GetResult")
            peer.call("send", number, [10**9])
            canceled = peer.call("cancel", [number, [0, 0]])
            return canceled, peer.call("result", number)

        canceled, result = while_running(twin, work)
    assert canceled["return_code"] == 0
    assert [item["goal_id"]["uuid"] for item in canceled["goals_canceling"]] == [[7] * 16]
    assert result["status"] == 5


def test_a_client_that_is_killed_while_it_waits(twin, caplog):
    """Its response goes nowhere; the others are answered, and nothing of it is kept."""
    twin.pause()
    with dds_peer(DOMAIN) as killed, dds_peer(DOMAIN) as other, caplog.at_level(logging.WARNING):

        def work():
            killed.client("send", f"{STEPS}/send_goal", "SendGoal")
            killed.client("result", f"{STEPS}/get_result", "GetResult")
            killed.call("send", [[7] * 16], [10**9])
            killed.ask("result", [[7] * 16])
            killed.kill()
            other.client("list", LIST, "ListParameters")
            other.client("cancel", f"{STEPS}/cancel_goal", "CancelGoal")
            names = other.names("list", 3)
            other.call("cancel", [[[7] * 16], [0, 0]])
            return names

        assert while_running(twin, work) == [NAMES]
    assert not [line for line in caplog.messages if "lost" in line]


def test_what_is_no_request_is_one_line_of_the_log(twin, caplog):
    no_text = "00010000" + "00" * 16 + "01000000 02000000 ff00".replace(" ", "") + "00" * (6 + 8)
    with dds_peer(DOMAIN) as peer, caplog.at_level(logging.WARNING):

        def work():
            peer.client("a", LIST, "ListParameters")
            for _ in range(3):
                peer.raw("a", no_text)
            return peer.names("a", 1)

        assert while_running(twin, work) == [NAMES]
    (line,) = [line for line in caplog.messages if line.startswith(LIST)]
    assert "28 bytes are not a rcl_interfaces/srv/ListParameters_Request" in line


def test_a_client_of_another_middleware_is_told_of_once(twin, caplog):
    """Fast DDS's clients have the same topics and types, but no header: their bytes must not be taken for one."""
    reason = "client is not of rmw_cyclonedds_cpp"
    with dds_peer(DOMAIN) as peer, caplog.at_level(logging.WARNING):

        def work():
            peer.client("fast", LIST, "ListParameters", data="other=1;")
            peer.client("a", LIST, "ListParameters")
            for _ in range(200):  # what is sent before they have found each other is lost
                peer.ask("fast", [], 0)
                assert peer.names("a", 1) == [NAMES]
                if any(reason in line for line in caplog.messages):
                    break
            for _ in range(3):
                peer.ask("fast", [], 0)
            return peer.names("a", 1)

        assert while_running(twin, work) == [NAMES]
    assert [line.startswith(LIST) for line in caplog.messages if reason in line] == [True]


def test_a_client_with_another_type_is_told_of_once(twin, caplog):
    """It waits for ever, as over DDS it does with a ROS node, but the twin says why."""
    with dds_peer(DOMAIN) as peer, caplog.at_level(logging.WARNING):

        def work():
            peer.client("wrong", LIST, "Other", is_wrong=True)
            peer.client("a", LIST, "ListParameters")
            while not any(line.startswith(LIST) for line in caplog.messages):
                peer.names("a", 1)

        while_running(twin, work)
    kinds = "std_srvs/srv/Trigger, but its type is rcl_interfaces/srv/ListParameters"
    assert [line for line in caplog.messages if line.startswith(LIST)] == [
        f"{LIST}: another program calls it as {kinds}"
    ]


SAYING = """
def say(*words):
    with open(__file__ + ".said", "a") as file:  # what nodes print is captured while they write
        print(*words, file=file)
"""


def said(node):
    """What a node has said so far."""
    file = node.with_name(f"{node.name}.said")
    return file.read_text() if file.exists() else ""


ASKING = f"""{HEAD}{SAYING}
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionClient
from simulation_interfaces.action import SimulateSteps

rclpy.init()
node = Node("asking")
client = node.create_client(AddTwoInts, "/elsewhere/add")
say("is there:", client.wait_for_service())
future = client.call_async(AddTwoInts.Request(a=2, b=40))
rclpy.spin_until_future_complete(node, future)
say("sum:", future.result().sum)

steps = ActionClient(node, SimulateSteps, "/elsewhere/steps")
steps.wait_for_server()
future = steps.send_goal_async(
    SimulateSteps.Goal(steps=3), lambda message: say("feedback:", message.feedback.completed_steps)
)
rclpy.spin_until_future_complete(node, future)
goal = future.result()
say("accepted:", goal.accepted)
future = goal.get_result_async()
rclpy.spin_until_future_complete(node, future)
say("result:", future.result().status, future.result().result.result.error_message)
other = node.create_client(AddTwoInts, "/nowhere")
other.call_async(AddTwoInts.Request())
say("at the end")
"""


def test_a_node_asks_services_and_actions_of_other_programs(tmp_path, caplog):
    """Of a server that is not there, one line says that the request is lost."""
    wire = DdsWire(DOMAIN)
    node = script(tmp_path, "asking.py", ASKING)
    with rovers(1).node(node).build() as twin, dds_peer(DOMAIN) as peer, caplog.at_level(logging.WARNING):
        seam = connect(twin, [wire], twin.companions[0])

        def work():
            peer.serve("/elsewhere/add", "AddTwoInts", [])
            peer.serve("/elsewhere/steps/_action/send_goal", "SendGoal", [True, [1, 2]])
            peer.serve("/elsewhere/steps/_action/cancel_goal", "CancelGoal", [0, []])
            peer.serve("/elsewhere/steps/_action/get_result", "GetResult", [4, [[1, "done"]]])
            until(lambda: said(node).endswith("at the end\n"))

        try:
            while_running(twin, work)
        finally:
            seam.close()
    assert said(node).splitlines() == [
        "is there: True",
        "sum: 42",
        "accepted: True",
        "result: 4 done",
        "at the end",
    ]
    (line,) = [line for line in caplog.messages if line.startswith("/nowhere")]
    assert line == (
        "/nowhere: a request is lost: it is called as example_interfaces/srv/AddTwoInts, but no node offers it"
    )


QUALITIES = f"""{HEAD}{SAYING}
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data

rclpy.init()
node = Node("qualities")
kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
node.create_publisher(String, "/kept", kept).publish(String(data="at the start"))
def hear(message):
    say("heard:", message.data)


node.create_subscription(String, "/sensed", hear, qos_profile_sensor_data)
rclpy.spin(node)
"""


def test_what_a_node_keeps_and_hears_of_best_effort(tmp_path):
    """A latched message from before the topic was on the wire, and one of a publisher that sensors have."""
    node = script(tmp_path, "node.py", QUALITIES)
    with rovers(1).node(node).build() as twin, dds_peer(DOMAIN) as peer:
        seam = connect(twin, [DdsWire(DOMAIN)], twin.companions[0])

        def work():
            peer.subscribe("/kept", "Text", is_latched=True)
            found = []
            while not found:
                found = peer.heard("/kept")
            while "heard: a scan" not in said(node):  # the first may come before the twin's reader knows the writer
                peer.publish("/sensed", "Text", "a scan", is_best_effort=True)
            return found

        try:
            assert while_running(twin, work) == [{"data": "at the start"}]
        finally:
            seam.close()


def test_services_that_nobody_calls_are_not_looked_at(twin, monkeypatch):
    """Neither in a step nor when a command comes, and the run has the same state as one without."""
    taken = []
    monkeypatch.setattr(DdsServer, "take", lambda self: taken.append(self) or False)
    with rovers(1).build() as alone:
        twin.advance_to(1.0)
        alone.advance_to(1.0)
        assert twin.state_sha256() == alone.state_sha256()
    assert sum(isinstance(item, DdsServer) for item in wire_of(twin)._readings) > 50
    assert not taken


def test_discovery_that_tells_more_than_was_announced(twin, monkeypatch):
    """What comes between the wait and the look is counted too, and no service is looked at for it."""
    wire, taken = wire_of(twin), []
    wire._is_closed.set()
    wire._thread.join()
    monkeypatch.setattr(DdsServer, "take", lambda self: taken.append(self) or False)
    monkeypatch.setattr(wire._discovery, "take", lambda: 3)
    wire._take(1)
    assert not taken
    wire._take(4)
    assert taken


def test_spawns_and_deletes_leave_no_service(twin):
    readings = wire_of(twin)._readings
    before = len(readings)
    for _ in range(3):
        twin.entities.spawn(Robot("guest", ROVER, xyz=(0, -3, 0.13)))
        twin.advance_to(twin.time + 0.02)
        assert len(readings) > before + 20
        twin.entities.delete("guest")
        twin.advance_to(twin.time + 0.02)
    assert len(readings) == before
