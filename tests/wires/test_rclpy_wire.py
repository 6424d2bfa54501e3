"""``--ros rclpy`` with a double of rclpy, which does what was recorded of the real one."""

import json
import logging
import os
import signal
import subprocess
import sys
import threading
from itertools import pairwise
from pathlib import Path

import pytest
from conftest import ROVER, rovers
from waiting import until
from wires.rclpy_network import DOUBLE, Network
from wires.ros_client import while_running

from drake_twin import Robot
from drake_twin.messages import float64_multi_array
from drake_twin.messages.draft import LaterDraft
from drake_twin.messages.field_types import field_types
from drake_twin.messages.interface_types import deserialize, make, serialize
from drake_twin.services.graph import connect
from drake_twin.twin.endpoints import PUBLISHED, Endpoint
from drake_twin.wires import rclpy_wire
from drake_twin.wires.outbox import OfferedTopic, Outbox
from drake_twin.wires.rclpy_wire import RclpyWire
from drake_twin.wires.wire import WireEndpoint

RECORDED = Path(__file__).parent / "rclpy_recorded.json"
STATES, COMMANDS = "/robot_1/joint_states", "/robot_1/forward_velocity_controller/commands"
LIST = "/robot_1/robot_state_publisher/list_parameters"
STRING = "std_msgs/msg/String"


@pytest.fixture
def network(tmp_path, monkeypatch):
    network = Network(tmp_path)
    for name, value in network.variables().items():
        monkeypatch.setenv(name, value)
    monkeypatch.delenv("RMW_IMPLEMENTATION", raising=False)
    yield network
    network.close()


@pytest.fixture
def wire(network):
    wire = RclpyWire(7)
    yield wire
    wire.close()


@pytest.fixture
def twin(network):
    with rovers(1).build() as twin:
        seam = connect(twin, [RclpyWire(7)])
        try:
            yield twin
        finally:
            seam.close()


def topic(name, node="/one", **options):
    return WireEndpoint(name, STRING, "", node, **options)


def velocity(told):
    return deserialize("sensor_msgs/msg/JointState", bytes.fromhex(told["data"])).velocity[0]


def text(value):
    return serialize(make(STRING, {"data": value}))


def test_the_double_does_what_the_real_rclpy_did():
    program = [sys.executable, str(Path(__file__).parent / "rclpy_contract.py"), "7"]
    environment = {**os.environ, "PYTHONPATH": str(DOUBLE)}
    said = subprocess.run(program, env=environment, stdout=subprocess.PIPE, check=True, text=True).stdout
    assert json.loads(said) == json.loads(RECORDED.read_text("utf-8"))


def test_fields_are_written_as_rosidls_python_classes_have_them():
    recorded = json.loads((DOUBLE / "recorded_fields.json").read_text("utf-8"))
    assert len(recorded) == 90
    for name, fields in recorded.items():
        assert dict(field_types(name)[name]) == {key: kind.replace(" ", "") for key, kind in fields.items()}, name


def test_nodes_topics_and_services_are_where_they_are_over_dds(twin, network):
    (states,) = network.wait("publisher", STATES)
    assert states["type"] == "sensor_msgs/msg/JointState"
    assert (states["node"], states["depth"], states["latched"]) == ("/robot_1/joint_state_broadcaster", 10, False)
    (description,) = network.wait("publisher", "/robot_1/robot_description")
    assert (description["node"], description["depth"], description["latched"]) == (
        "/robot_1/robot_state_publisher",
        1,
        True,
    )
    until(lambda: any("lifespan" in each for each in network.of("publisher", "/rosout")))
    (log,) = (each for each in network.of("publisher", "/rosout") if "lifespan" in each)
    assert (log["depth"], log["latched"], log["lifespan"]) == (1000, True, 10 * 10**9)  # as rcl's
    assert network.wait("subscription", COMMANDS)[0]["node"] == "/robot_1/forward_velocity_controller"
    manager = "/robot_1/controller_manager"
    (service,) = network.wait("service", f"{manager}/list_controllers")
    assert (service["type"], service["node"]) == ("controller_manager_msgs/srv/ListControllers", manager)


def test_each_node_publishes_its_log(twin, network):
    network.wait("publisher", STATES)
    nodes = {item.node for item in twin.graph.endpoints}
    until(lambda: nodes <= {each["node"] for each in network.of("publisher", "/rosout")})
    assert not any("/_" in each["node"] for each in network.of("publisher", "/rosout"))


def test_the_description_is_there_for_late_joiners(twin, network):
    twin.advance_to(0.3)
    (message,) = network.wait("message", "/robot_1/robot_description")
    data = deserialize(STRING, bytes.fromhex(message["data"])).data
    assert data == twin.latest("/robot_1/robot_description").data


def test_joint_states_come_once_each_while_somebody_listens(twin, network):
    def work():
        network.wait("publisher", STATES)
        assert not network.of("message", STATES)
        network.do("subscribe", STATES)
        found = network.wait("message", STATES, 50)
        network.do("leave", STATES)
        return found

    heard = while_running(twin, work)
    stamps = [deserialize("sensor_msgs/msg/JointState", bytes.fromhex(each["data"])).header.stamp for each in heard]
    times = [stamp.sec * 10**9 + stamp.nanosec for stamp in stamps]
    assert {after - before for before, after in pairwise(times[1:])} == {10_000_000}


def test_commands_move_the_robot(twin, network):
    def work():
        network.wait("subscription", COMMANDS)
        network.do("publish", COMMANDS, data=serialize(float64_multi_array([3.0] * 4)))
        network.do("subscribe", STATES)
        until(lambda: velocity(network.wait("message", STATES)[-1]) > 1)

    while_running(twin, work)
    assert list(twin.graph.command(COMMANDS).data) == [3.0] * 4


def test_services_answer(twin, network):
    request = serialize(make("rcl_interfaces/srv/ListParameters_Request", {}))

    def work():
        network.wait("service", LIST)
        for number in range(100):
            network.do("ask", LIST, number=number, data=request)
        return network.wait("response", LIST, 100)

    responses = while_running(twin, work)
    assert sorted(each["number"] for each in responses) == list(range(100))
    for each in responses:
        response = deserialize("rcl_interfaces/srv/ListParameters_Response", bytes.fromhex(each["data"]))
        assert "robot_description" in response.result.names


def test_the_parts_of_an_action_are_those_of_the_machines_class(wire, network, caplog):
    name, kind = "/arm/follow_joint_trajectory/_action", "control_msgs/action/FollowJointTrajectory"
    for part in ("SendGoal", "GetResult"):
        wire.serve(WireEndpoint(f"{name}/{part}", f"{kind}_{part}", "", "/arm/arm"), print)
        assert network.wait("service", f"{name}/{part}")
    wire.advertise(WireEndpoint(f"{name}/feedback", f"{kind}_FeedbackMessage", "", "/arm/arm"), print)
    assert network.wait("publisher", f"{name}/feedback")
    assert not caplog.messages


def test_robots_that_come_and_go_bring_and_take_their_endpoints(twin, network):
    twin.entities.spawn(Robot("robot_2", ROVER, xyz=(0, 3, 0.13)))
    twin.advance_to(twin.time + 0.01)
    assert network.wait("publisher", "/robot_2/joint_states")
    twin.entities.delete("robot_2")
    twin.advance_to(twin.time + 0.01)
    for end in ("publisher", "subscription", "service"):
        came = {each["name"] for each in network.told if each["what"] == end and each["name"].startswith("/robot_2/")}
        until(lambda end=end, came=came: came <= {each["name"] for each in network.told if each["what"] == f"no {end}"})


def test_what_the_twin_publishes_does_not_come_back_to_it(wire, network):
    heard, listened = [], []
    sender = wire.advertise(topic("/t"), listened.append)
    wire.listen(topic("/t"), heard.append)
    sender.send(text("own"), 0)
    sender.flush()
    network.wait("message", "/t")
    network.do("publish", "/t", data=text("other"))
    until(lambda: heard)
    assert [deserialize(STRING, data).data for data in heard] == ["other"]
    network.do("subscribe", "/t")
    until(lambda: sender.is_heard)
    network.do("leave", "/t")
    until(lambda: not sender.is_heard)
    assert listened == [True, False]


def test_services_of_others_are_asked(wire, network):
    changes, answers = [], []
    service = WireEndpoint("/add", "rcl_interfaces/srv/ListParameters", "", "/one")
    client = wire.client(service, lambda: changes.append(client.is_there))
    network.wait("client", "/add")
    assert not client.is_there
    network.do("serve", "/add")
    until(lambda: client.is_there)
    request = serialize(make("rcl_interfaces/srv/ListParameters_Request", {"depth": 3}))
    for _ in range(2):
        client.ask(request, answers.append)
    asked = network.wait("request", "/add", 2)
    assert [bytes.fromhex(each["data"]) for each in asked] == [request] * 2
    response = serialize(make("rcl_interfaces/srv/ListParameters_Response", {}))
    network.do("answer", "/add", number=asked[1]["number"], data=response)
    until(lambda: answers == [response])
    network.do("leave", "/add")
    until(lambda: changes == [True, False])


def test_packages_that_are_missing_are_told_in_one_line(twin, network, caplog):
    def lines():
        return [line for line in caplog.messages if "lacks packages" in line]

    until(lines)
    (line,) = lines()
    assert "of simulation_interfaces /drake_twin/" in line
    assert "of gazebo_msgs /" in line
    assert "`sudo apt install ros-jazzy-" in line
    assert " ros-jazzy-simulation-interfaces" in line
    assert network.of("publisher", STATES)


def test_a_type_with_other_fields_is_told_and_not_published(wire, network, caplog, monkeypatch):
    monkeypatch.setattr(rclpy_wire, "field_types", lambda name: {name: [("data", "string"), ("more", "double")]})
    wire.advertise(topic("/t"), lambda is_heard: None)
    wire.advertise(topic("/u"), lambda is_heard: None)
    until(lambda: caplog.messages)
    assert caplog.messages == [f"/t, /u: the {STRING} of this ROS 2 is another one: it has no field more"]
    assert not network.of("publisher", "/t")


def test_another_program_with_another_type_is_told_once(wire, network, caplog):
    wire.listen(topic("/t"), print)
    network.wait("subscription", "/t")
    network.do("typed", "/t", type="std_msgs/msg/Int8")
    until(lambda: caplog.messages)
    assert caplog.messages == [f"/t: another program has it as std_msgs/msg/Int8, but its type is {STRING}"]


def test_names_that_are_none_of_ros_are_not_on_the_graph(wire, caplog):
    assert not wire.advertise(topic("/a b"), print).is_heard
    assert caplog.messages == ["/a b of /one is not on the graph: it is not a name of ROS"]


def test_a_process_that_dies_is_told_and_the_simulation_continues(twin, network, caplog):
    wire = twin.inbox.looks[0].__self__._wires[0]
    network.wait("publisher", STATES)
    wire._process._process.send_signal(signal.SIGKILL)
    until(lambda: any("no longer on the graph" in line for line in caplog.messages))
    (line,) = [line for line in caplog.messages if "no longer on the graph" in line]
    assert line.endswith("and the simulation continues: its process has ended with -9")
    twin.advance_to(twin.time + 0.1)


def test_a_twin_that_is_killed_takes_its_nodes_along(network):
    program = (
        "from drake_twin.wires.rclpy_wire import RclpyWire; w = RclpyWire(7); print(w._process._process.pid); input()"
    )
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    process = subprocess.Popen([sys.executable, "-c", program], **pipes)
    pid = int(process.stdout.readline())
    os.kill(pid, 0)  # it is there
    process.kill()
    process.communicate()
    until(lambda: not _runs(pid))


def _runs(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().split()[2] != "Z"
    except FileNotFoundError:
        return False


def test_a_close_lets_all_messages_out_and_ends_the_nodes(network, caplog):
    wire = RclpyWire(7)
    sender = wire.advertise(topic("/t"), lambda is_heard: None)
    for number in range(1000):
        sender.send(text(str(number)), 0)
    wire.close()
    said = network.wait("message", "/t", 1000)
    assert [deserialize(STRING, bytes.fromhex(each["data"])).data for each in said] == [str(n) for n in range(1000)]
    assert network.wait("no publisher", "/t")
    assert wire._process._process.returncode == 0
    assert not [line for line in caplog.records if line.levelno >= logging.WARNING]


class Counting:
    """A file that counts what is written to it."""

    def __init__(self, file):
        self.file, self.count = file, 0

    def write(self, data):
        self.count += 1
        return self.file.write(data)

    def close(self):
        self.file.close()


def test_messages_of_one_moment_are_written_at_once(wire, network):
    """A process that wakes up for each message would cost as much as the messages."""
    sender = wire.advertise(topic("/t", latched=True), lambda is_heard: None)
    offered, go = OfferedTopic(Endpoint(PUBLISHED, "/t", STRING, "/one"), [sender]), threading.Event()
    wire.pipe._file = counting = Counting(wire.pipe._file)
    outbox = Outbox(print)
    outbox.put(offered, LaterDraft(lambda: go.wait() and make(STRING, {"data": "first"})), 0.0)
    for _ in range(100):
        outbox.put(offered, LaterDraft(lambda: make(STRING, {"data": "next"})), 0.0)
    go.set()
    outbox.flush()
    assert counting.count == 1
    assert len(network.wait("message", "/t", 101)) == 101
    outbox.put(offered, LaterDraft(lambda: make(STRING, {"data": "last"})), 0.0)
    network.wait("message", "/t", 102)  # though nobody waits for it
    outbox.close()
