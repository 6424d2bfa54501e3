"""``--ros zenoh``: what is said, what is refused, and that the program ends."""

import os
import signal
import socket
import subprocess
import sys

import pytest
from program_runs import ROVER, refused
from wires.zenoh_peer import Heard, free_port, peer, tokens

from drake_twin import TwinBuilder
from drake_twin.cli.options import parser
from drake_twin.cli.wires import open_wires
from drake_twin.messages.interface_types import deserialize, make, serialize, type_hash
from drake_twin.run import main
from drake_twin.wires.rmw_zenoh_format import attachment, topic_key

pytest.importorskip("zenoh")

STEP = "simulation_interfaces/srv/StepSimulation"


def start(*options, **environment):
    """The program in a process of its own, once it has said where it is open."""
    program = [sys.executable, "-m", "drake_twin.run", "--robots", "1", "--headless", "--ros", "zenoh"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    process = subprocess.Popen([*program, *map(str, options)], env=os.environ | environment, **pipes)
    return process, process.stdout.readline()


def call(session, service, kind, **fields):
    """Calls a service, once the session knows who answers; returns the responses."""
    querier = session.declare_querier(topic_key(0, service, kind, type_hash(kind)), timeout=60.0)
    heard = Heard()
    listener = querier.declare_matching_listener(heard)
    if not querier.matching_status.matching:
        heard.wait_for(lambda items: any(item.matching for item in items), timeout=60.0)
    listener.undeclare()
    data = serialize(make(f"{kind}_Request", fields))
    replies = list(querier.get(payload=data, attachment=attachment(1, 1, bytes(16))))
    querier.undeclare()
    return [deserialize(f"{kind}_Response", reply.ok.payload.to_bytes()) for reply in replies if reply.ok]


def test_a_topic_for_the_bag_that_nobody_publishes_is_said(tmp_path, capsys):
    options = ["--robots", "1", "--headless", "--duration", "0.01", "--bag", str(tmp_path / "bag")]
    assert main([*options, "--bag-topic", "/robot_1/joint_state", "--bag-topic", "/clock"]) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert "nothing is published on '/robot_1/joint_state' yet. Did you mean '/robot_1/joint_states'?" in line


def test_the_start_up_message_names_the_open_port_and_says_that_there_is_no_token(capsys, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    port = free_port()
    assert main(["--robots", "1", "--headless", "--duration", "0.05", "--ros", "zenoh", "--ros-port", str(port)]) == 0
    captured = capsys.readouterr()
    assert captured.out.splitlines()[0] == (
        f"ros: domain 7 over Zenoh (RMW_IMPLEMENTATION=rmw_zenoh_cpp), open on 127.0.0.1:{port}, as router"
    )
    assert "ros: this protocol has no token: every program that reaches the port commands the robots" in captured.err
    with socket.create_server(("127.0.0.1", port)):  # the port is free again
        pass


def test_a_second_twin_connects_to_the_first(capsys):
    port = free_port()
    first, said = start("--ros-port", port)
    try:
        assert said.endswith(f"open on 127.0.0.1:{port}, as router\n")
        arguments = ["--robots", "1", "--headless", "--duration", "0.05", "--ros", "zenoh"]
        assert main([*arguments, "--ros-port", str(port)]) == 0
        assert f", connected to the router at 127.0.0.1:{port}\n" in capsys.readouterr().out
        assert main([*arguments, "--ros-router", f"localhost:{port}"]) == 0
        assert f", connected to the router at localhost:{port}\n" in capsys.readouterr().out
    finally:
        first.kill()
        first.wait()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_process(number):
    process, _ = start("--ros-port", free_port(), "--echo", "/clock")
    while "nanosec" not in process.stdout.readline():  # until it runs
        pass
    process.send_signal(number)
    said, _ = process.communicate(timeout=60)
    assert process.returncode == 0, said
    assert "1 robot, " in said


def test_an_error_ends_the_process():
    process, said = start("--ros-port", free_port(), "--pub", "/nobody", "[1]")
    rest, _ = process.communicate(timeout=60)
    assert process.returncode == 2
    assert "error: " in said + rest


def test_a_twin_that_is_rebuilt_takes_the_place_of_the_one_before():
    """As after a change of a file with --watch."""
    port = free_port()
    options = parser().parse_args(["--ros", "zenoh", "--ros-port", str(port), "--lockstep"])
    with open_wires(options) as graph:
        for name in ("first", "second"):
            with TwinBuilder().robot(name, ROVER).build() as twin:
                graph.connect(twin)
                with peer(port) as session:
                    robots = {text.split("/")[7] for text in tokens(session) if "/controller_manager" in text}
                assert robots == {f"%{name}"}
                assert twin.frames.lockstep
    with socket.create_server(("127.0.0.1", port)):
        pass


def test_what_is_refused(capsys, monkeypatch):
    zenoh = ("--robots", 1, "--ros", "zenoh")
    assert "'ddt'" in refused(capsys, "--ros", "ddt")
    assert "--lockstep is about the ROS 2 graph: it needs --ros zenoh" in refused(capsys, "--lockstep")
    assert "--ros-port 80: the router's port must be" in refused(capsys, *zenoh, "--ros-port", 80)
    assert "give one of them" in refused(capsys, *zenoh, "--ros-host", "0.0.0.0", "--ros-router", "x")
    assert "cannot listen on 203.0.113.5" in refused(capsys, *zenoh, "--ros-host", "203.0.113.5")
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        assert f"no Zenoh router answers at 127.0.0.1:{port}" in refused(capsys, *zenoh, "--ros-port", port)
    monkeypatch.setenv("ROS_DOMAIN_ID", "seven")
    assert "ROS_DOMAIN_ID=seven: a ROS domain is" in refused(capsys, *zenoh)


def test_zenoh_that_is_not_installed(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "zenoh", None)
    assert "pip install 'eclipse-zenoh>=" in refused(capsys, "--robots", 1, "--ros", "zenoh")


def test_lockstep():
    """Time advances by the steps that are asked for, and by no others: the run of 0.1 s ends with the last of them."""
    port = free_port()
    process, _ = start("--ros-port", port, "--lockstep", "--duration", 0.1)
    try:
        with peer(port) as session:
            for _ in range(9):
                (response,) = call(session, "/drake_twin/step_simulation", STEP, steps=10)
                assert response.result.result == 1
            call(session, "/drake_twin/step_simulation", STEP, steps=10)  # the program may end before it answers
        said, _ = process.communicate(timeout=60)
    finally:
        process.kill()
        process.wait()
    assert "1 robot, 0.100 s simulated" in said
    assert process.returncode == 0
