"""``--ros rclpy`` with the machine's own ROS 2, where one is sourced: ``pytest -m ros``."""

import json
import os
import subprocess
from pathlib import Path

import pytest
from conftest import rovers
from program_runs import run
from waiting import until
from wires.ros_client import while_running

from drake_twin.messages.interface_types import deserialize, make, serialize
from drake_twin.services.graph import connect
from drake_twin.wires.rclpy_process import find_rclpy
from drake_twin.wires.rclpy_wire import RclpyWire
from drake_twin.wires.wire import WireEndpoint

pytestmark = pytest.mark.ros
DOMAIN = 180 + int(os.environ.get("PYTEST_XDIST_WORKER", "gw0")[2:])
HERE = Path(__file__).parent


def with_rclpy(program):
    """Runs a program with a Python that has this rclpy; returns what it prints."""
    rclpy = find_rclpy()
    for python in rclpy.interpreters():
        if subprocess.run([python, "-c", "import rclpy"], capture_output=True, check=False).returncode == 0:
            pipes = {"stdout": subprocess.PIPE, "check": True, "text": True}
            return json.loads(subprocess.run([python, str(HERE / program), str(DOMAIN)], **pipes).stdout)
    raise AssertionError(f"no Python has {rclpy}")


def test_the_double_still_does_what_the_real_rclpy_does():
    assert with_rclpy("rclpy_contract.py") == json.loads((HERE / "rclpy_recorded.json").read_text("utf-8"))


def test_a_real_node_hears_calls_and_commands():
    with rovers(1).build() as twin:
        seam = connect(twin, [RclpyWire(DOMAIN)])
        try:
            found = while_running(twin, lambda: with_rclpy("rclpy_peer.py"))
            description = twin.latest("/robot_1/robot_description").data
        finally:
            seam.close()
    assert found["periods"] == [10_000_000]
    assert found["descriptions"] == [description]
    assert found["answered"] == 1000
    assert found["moves"]
    assert {
        "/drake_twin",
        "/robot_1/controller_manager",
        "/robot_1/forward_velocity_controller",
        "/robot_1/joint_state_broadcaster",
        "/robot_1/robot_state_publisher",
        "/robot_state_publisher",
    } <= set(found["nodes"])


def test_what_the_twin_publishes_does_not_come_back_to_it():
    endpoint = WireEndpoint("/t", "std_msgs/msg/String", "", "/one")
    wires = [RclpyWire(DOMAIN), RclpyWire(DOMAIN)]
    heard, senders = ([], []), []

    def send(text):
        for index, sender in enumerate(senders):
            sender.send(serialize(make(endpoint.type, {"data": f"{index}{text}"})), 0)
            sender.flush()

    def texts(index, start):
        return [text for data in heard[index] if (text := deserialize(endpoint.type, data).data)[1] == start]

    def are_connected():
        send("?")
        return all(heard)

    try:
        for wire, messages in zip(wires, heard, strict=True):
            wire.listen(endpoint, messages.append)
            senders.append(wire.advertise(endpoint, lambda is_heard: None))
        until(are_connected)
        for length in range(1, 5):  # of those of both wires, a subscription keeps ten
            send("!" * length)
        until(lambda: all(len(texts(index, "!")) == 4 for index in (0, 1)))
    finally:
        for wire in wires:
            wire.close()
    for index in (0, 1):
        other = 1 - index
        assert texts(index, "!") == [f"{other}!", f"{other}!!", f"{other}!!!", f"{other}!!!!"]
        assert set(texts(index, "?")) == {f"{other}?"}


def test_a_second_twin_is_refused():
    with rovers(1).build() as twin:
        seam = connect(twin, [RclpyWire(DOMAIN)])
        try:
            second = run("--robots", 1, "--headless", "--duration", 0.01, "--ros", "rclpy", "--ros-domain", DOMAIN)
        finally:
            seam.close()
    assert (second.returncode, "Traceback" in second.stderr) == (2, False)
    assert f"error: another twin is on ROS domain {DOMAIN} and publishes /clock" in second.stderr
