"""Foxglove's web socket, against Foxglove's own client."""

import base64
import json
import logging
import os
import re
import socket
import threading
from itertools import pairwise
from pathlib import Path

import pytest
from conftest import ARM, rovers
from rosbags.typesys import Stores, get_typestore
from wires.foxglove_peer import foxglove_peer
from wires.ros_client import while_running
from wires.zenoh_peer import free_port

from drake_twin import TwinBuilder
from drake_twin.errors import InputError
from drake_twin.messages import float64_multi_array
from drake_twin.messages.interface_types import deserialize, make, serialize
from drake_twin.services.assets import Assets
from drake_twin.services.graph import connect
from drake_twin.twin.replay import replay
from drake_twin.wires.foxglove_wire import FoxgloveWire

pytest.importorskip("foxglove", reason="foxglove-sdk is not installed")

JAZZY = get_typestore(Stores.ROS2_JAZZY)
STATES = "/robot_1/joint_states"
COMMANDS = "/robot_1/forward_velocity_controller/commands"
ARRAY = "std_msgs/msg/Float64MultiArray"
LIST = "/robot_1/controller_manager/list_controllers"


def served(twin, **options):
    wire = FoxgloveWire(port=0, **options)
    return wire, connect(twin, [wire])


@pytest.fixture
def shown():
    """A twin of two rovers, and the address at which it is shown."""
    with rovers(2).build() as twin:
        wire, seam = served(twin)
        yield twin, wire.place
        seam.close()


@pytest.fixture
def controlled():
    with rovers(2).build() as twin:
        wire, seam = served(twin, control=True)
        yield twin, wire.place
        seam.close()


def stamps(client, topic):
    kind = "sensor_msgs/msg/JointState"
    found = [JAZZY.deserialize_cdr(base64.b64decode(item["data"]), kind) for item in client.of("message", topic=topic)]
    return [message.header.stamp.sec * 10**9 + message.header.stamp.nanosec for message in found]


def heard(twin):
    """The topics that somebody listens to, of those that change."""
    return [item.topic for item in twin._session.subscriptions._items if not item.is_latched]


def wait_for_silence(twin):
    while_running(twin, lambda: None)
    twin.run(each_frame=lambda: bool(heard(twin)) and twin.time < 300.0)
    assert not heard(twin)


def test_joint_states_come_without_a_gap_and_with_the_simulations_time(shown):
    twin, place = shown
    with foxglove_peer(place) as client:

        def work():
            client.subscribe(STATES)
            return client.wait("message", 201, topic=STATES)

        found = while_running(twin, work)
        times = [item["time"] for item in found]
        assert {after - before for before, after in pairwise(times[1:])} == {10_000_000}
        assert stamps(client, STATES)[: len(times)] == times
        channel = next(item["channel"] for item in client.of("channel") if item["channel"]["topic"] == STATES)
        assert (channel["encoding"], channel["schemaName"]) == ("cdr", "sensor_msgs/msg/JointState")
        assert channel["schema"].startswith(JAZZY.generate_msgdef("sensor_msgs/msg/JointState", ros_version=2)[0][:80])
        told = [item["time"] for item in client.of("time")]
        assert told == sorted(told)
        assert {10_000_000} == {after - before for before, after in pairwise(told[2:])}


def test_a_late_joiner_gets_the_description(shown):
    twin, place = shown
    twin.advance_to(0.5)
    with foxglove_peer(place) as client:
        client.subscribe("/robot_1/robot_description")
        (found,) = client.wait("message", topic="/robot_1/robot_description")
    message = JAZZY.deserialize_cdr(base64.b64decode(found["data"]), "std_msgs/msg/String")
    assert message.data == twin.latest("/robot_1/robot_description").data


def test_a_topic_that_nobody_subscribes_to_is_not_evaluated(shown):
    twin, place = shown
    with foxglove_peer(place) as client:
        client.wait("channel", 5)
        twin.advance_to(0.2)
        assert not heard(twin)
        while_running(twin, lambda: (client.subscribe(STATES), client.wait("message", topic=STATES)))
        assert sorted(heard(twin)) == ["/clock", STATES]  # the clock for the time of all clients
        client.do("unsubscribe", topic=STATES)
        wait_for_silence(twin)


def test_a_client_that_leaves_ends_its_subscriptions(shown):
    twin, place = shown
    for _ in range(5):
        with foxglove_peer(place) as client:
            while_running(twin, lambda: (client.subscribe(STATES), client.wait("message", topic=STATES)))
        wait_for_silence(twin)


def test_a_reset_begins_the_session_anew(shown):
    twin, place = shown
    with foxglove_peer(place) as client:
        while_running(twin, lambda: (client.subscribe(STATES), client.wait("message", 20, topic=STATES)))
        before = len(client.of("info"))
        twin.reset()
        while_running(twin, lambda: client.wait("info", before + 1))
        ids = {item["info"]["sessionId"] for item in client.of("info")}
        assert len(ids) == 2


def test_without_control_nothing_is_offered_to_clients(shown):
    twin, place = shown
    with foxglove_peer(place) as client:
        capabilities = client.of("info")[0]["info"]["capabilities"]
        assert set(capabilities) == {"time", "assets", "connectionGraph", "parameters", "parametersSubscribe"}
        client.publish(COMMANDS, ARRAY, serialize(float64_multi_array([3.0] * 4)))
        while_running(twin, lambda: (client.subscribe(STATES), client.wait("message", 20, topic=STATES)))
        assert not client.of("service")
    assert twin.graph.command(COMMANDS) is None


@pytest.mark.parametrize("encoding", ["cdr", "json"])
def test_commands_are_recorded_and_replayed(controlled, encoding):
    twin, place = controlled
    twin.recorder.begin()
    data = {"cdr": serialize(float64_multi_array([3.0] * 4)), "json": json.dumps({"data": [3.0] * 4}).encode()}
    with foxglove_peer(place) as client:

        def work():
            client.subscribe(STATES)
            client.wait("message", 10, topic=STATES)
            client.publish(COMMANDS, ARRAY, data[encoding], encoding)
            client.wait("message", len(client.of("message", topic=STATES)) + 40, topic=STATES)

        while_running(twin, work)
    assert list(twin.graph.command(COMMANDS).data) == [3.0] * 4
    assert twin.robot_state("robot_1").base_pose[0] > 0.005
    with replay(twin.recorder.recording()) as again:
        assert again.state_sha256() == twin.state_sha256()


def test_a_service_is_called_and_a_refusal_is_in_its_answer(controlled):
    twin, place = controlled
    kind = "controller_manager_msgs/srv/ListControllers"
    with foxglove_peer(place) as client:
        answer = while_running(twin, lambda: client.call(LIST, serialize(make(f"{kind}_Request", {}))))
    names = [item.name for item in deserialize(f"{kind}_Response", answer).controller]
    assert "forward_velocity_controller" in names


def test_what_cannot_be_read_is_one_line_of_the_log(controlled, caplog):
    twin, place = controlled
    with foxglove_peer(place) as client:

        def work():
            client.subscribe(STATES)
            for _ in range(3):
                client.publish("/nobody", ARRAY, b"x")
                client.publish(COMMANDS, ARRAY, b"{", "json")
                client.publish("/robot_2/forward_velocity_controller/commands", ARRAY, os.urandom(50))
            client.wait("message", 30, topic=STATES)

        with caplog.at_level(logging.WARNING):
            while_running(twin, work)
    lines = [item.getMessage() for item in caplog.records if item.name == "drake_twin.wires.foxglove_clients"]
    lines += [item.getMessage() for item in caplog.records if item.name == "drake_twin.wires.seam"]
    assert len(lines) == 3
    assert any(line.startswith("/nobody: nothing listens to it") for line in lines)


def test_a_connection_that_sends_anything_ends_alone(controlled):
    twin, place = controlled
    host, port = place.removeprefix("ws://").split(":")
    for data in (os.urandom(2000), b"GET / HTTP/1.1\r\n" + b"a" * 100_000, b""):
        with socket.create_connection((host, int(port))) as probe:
            probe.sendall(data)
    with foxglove_peer(place) as client:
        while_running(twin, lambda: (client.subscribe(STATES), client.wait("message", 5, topic=STATES)))


def test_the_same_run_with_and_without_has_the_same_state():
    with rovers(2).build() as twin, rovers(2).build() as alone:
        wire, seam = served(twin, control=True)
        with foxglove_peer(wire.place) as client:
            while_running(twin, lambda: (client.subscribe(STATES), client.wait("message", 20, topic=STATES)))
        alone.advance_to(twin.time)
        assert twin.state_sha256() == alone.state_sha256()
        seam.close()


def test_assets_are_files_of_the_robots_packages_only(tmp_path):
    with TwinBuilder().robot("arm", ARM).build() as twin:
        wire, seam = served(twin, asset=Assets(twin))
        mesh = Path("models/arduinobot_description/meshes/turret.stl").resolve()
        outside = tmp_path / "secret.stl"
        outside.write_text("secret")
        with foxglove_peer(wire.place) as client:
            assert client.asset(1, "package://arduinobot_description/meshes/turret.stl") == mesh.read_bytes()
            assert client.asset(2, f"file://{mesh}") == mesh.read_bytes()
            for number, address in enumerate(
                (
                    "package://arduinobot_description/../../pyproject.toml",
                    "package://arduinobot_description/../rover_description/package.xml",
                    f"file://{outside}",
                    "file:///etc/passwd",
                    "/etc/passwd",
                    "package://rover_description/urdf/rover.urdf.xacro",
                    "package://arduinobot_description/meshes",
                    "package://arduinobot_description/none.stl",
                    "http://localhost/a.stl",
                    "package://" + "a" * 100_000,
                    "\0",
                ),
                3,
            ):
                assert client.asset(number, address) is None, address
        seam.close()


def test_links_do_not_lead_out_of_a_package(tmp_path):
    package = tmp_path / "linked"
    package.mkdir()
    (package / "package.xml").write_text("<package><name>linked</name></package>")
    (tmp_path / "secret.txt").write_text("secret")
    (package / "link.txt").symlink_to(tmp_path / "secret.txt")
    (package / "own.txt").write_text("own")
    robot = package / "robot.urdf"
    robot.write_text(
        '<robot name="r"><link name="base"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
    )
    with TwinBuilder().robot("r", str(robot)).build() as twin:
        assets = Assets(twin)
        assert assets("package://linked/own.txt") == b"own"
        assert assets("package://linked/link.txt") is None


def test_a_taken_port_is_one_paragraph():
    port = free_port()
    with (
        socket.create_server(("127.0.0.1", port)),
        pytest.raises(InputError, match=re.escape(f"127.0.0.1:{port} cannot be opened")),
    ):
        FoxgloveWire(port=port)


def test_a_closed_wire_leaves_no_thread_and_no_port():
    before = set(threading.enumerate())
    with rovers(1).build() as twin:
        wire, seam = served(twin, control=True)
        port = int(wire.place.rpartition(":")[2])
        twin.advance_to(0.1)
        seam.close()
    assert set(threading.enumerate()) <= before
    with socket.create_server(("127.0.0.1", port)):
        pass
