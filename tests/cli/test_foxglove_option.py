"""``--foxglove``: what is said, what is refused, and that the program ends."""

import signal
import socket
import subprocess
import sys

import pytest
from program_runs import ROVER, refused
from wires.foxglove_client import foxglove_client
from wires.zenoh_peer import free_port

from drake_twin import InputError, TwinBuilder
from drake_twin.cli.options import parser
from drake_twin.cli.wires import open_wires
from drake_twin.run import main

pytest.importorskip("foxglove", reason="foxglove-sdk is not installed")
RUN = ["--robots", "1", "--headless", "--duration", "0.05"]


@pytest.mark.parametrize(
    ("options", "does", "what"),
    [
        ([], "only shows; --foxglove-control commands, too", "every program that reaches the port sees the robots"),
        (["--foxglove-control"], "shows and commands", "every program that reaches the port commands the robots"),
    ],
)
def test_the_start_up_message_names_the_open_port_and_says_that_there_is_no_token(capsys, options, does, what):
    port = free_port()
    assert main([*RUN, "--foxglove", "--foxglove-port", str(port), *options]) == 0
    captured = capsys.readouterr()
    assert captured.out.splitlines()[0] == f"foxglove: ws://127.0.0.1:{port}, {does}"
    assert "foxglove: this protocol has no token" in captured.err
    assert what in captured.err
    with socket.create_server(("127.0.0.1", port)):
        pass


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--foxglove-control"], "--foxglove-control is about Foxglove: it needs --foxglove"),
        (["--foxglove-port", "8765"], "it needs --foxglove"),
        (["--foxglove-host", "127.0.0.1"], "it needs --foxglove"),
        (["--foxglove", "--foxglove-port", "80"], "the port must be from 1024 to 65535"),
        (["--foxglove", "--foxglove-host", "not an address"], "cannot be opened"),
    ],
)
def test_what_cannot_be_is_refused(capsys, options, words):
    assert words in refused(capsys, *RUN, *options)


def test_a_taken_port_is_refused(capsys):
    port = free_port()
    with socket.create_server(("127.0.0.1", port)):
        said = refused(capsys, *RUN, "--foxglove", "--foxglove-port", str(port))
    assert f"--foxglove: 127.0.0.1:{port} cannot be opened: Address already in use." in said


def test_without_the_sdk_the_command_that_installs_it_is_named(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "foxglove", None)
    assert "pip install 'foxglove-sdk>=" in refused(capsys, *RUN, "--foxglove")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_process(number):
    program = [sys.executable, "-m", "drake_twin.run", "--robots", "1", "--headless", "--foxglove", "--echo", "/clock"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    with subprocess.Popen([*program, "--foxglove-port", str(free_port())], **pipes) as process:
        while "nanosec" not in process.stdout.readline():  # until it runs
            pass
        process.send_signal(number)
        said, _ = process.communicate(timeout=60)
    assert process.returncode == 0, said


def test_a_signal_ends_the_process_while_a_client_reads_and_a_request_waits():
    port = free_port()
    program = [sys.executable, "-m", "drake_twin.run", "--robots", "1", "--headless", "--foxglove"]
    options = ["--foxglove-control", "--foxglove-port", str(port)]
    process = subprocess.Popen([*program, *options], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        process.stdout.readline()
        with foxglove_client(port) as client:
            client.subscribe("/robot_1/joint_states")
            client.messages("/robot_1/joint_states", 5)
            for _ in range(20):
                client.do("raw", text='{"op": ')  # said once
            assert client.call("/robot_1/controller_manager/list_controllers")["controller"]
            client.send_call("/drake_twin/get_entities")
            process.send_signal(signal.SIGINT)
            said, _ = process.communicate(timeout=60)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 0, said
    assert [line for line in said.splitlines() if line.startswith(("warning", "error"))] == [
        "warning: foxglove: Invalid message from a client: EOF while parsing a value at line 1 column 7"
    ]


def test_a_twin_that_is_rebuilt_takes_the_place_of_the_one_before():
    """As after a change of a file with --watch: the port is the same, the robots are the present ones."""
    port = free_port()
    options = parser().parse_args(["--foxglove", "--foxglove-port", str(port)])
    with open_wires(options) as wires:
        for name in ("first", "second"):
            with TwinBuilder().robot(name, ROVER).build() as twin:
                wires.connect(twin)
                with foxglove_client(port) as client:
                    client.channel(f"/{name}/joint_states")
                    topics = {item["topic"] for told in client.all("advertise") for item in told["channels"]}
                    assert {topic.split("/")[1] for topic in topics if topic.endswith("/joint_states")} == {name}
                    assert client.fetch("package://rover_description/package.xml")
    with socket.create_server(("127.0.0.1", port)):
        pass


def test_a_port_that_is_taken_when_a_twin_is_rebuilt_is_one_error(monkeypatch):
    port = free_port()
    options = parser().parse_args(["--foxglove", "--foxglove-port", str(port)])
    others = []

    def close_and_lose_the_port():
        close()
        others.append(socket.create_server(("127.0.0.1", port)))

    with TwinBuilder().robot("one", ROVER).build() as twin:
        with open_wires(options) as wires:
            wires.connect(twin)
            close = wires._seam.close
            monkeypatch.setattr(wires._seam, "close", close_and_lose_the_port)
            with pytest.raises(InputError, match="cannot be opened"):
                wires.connect(twin)
        others[0].close()
        twin.advance_to(0.1)
