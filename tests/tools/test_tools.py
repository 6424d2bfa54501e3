"""The tools without ROS beside a running twin: what they print, what they do to it, what they refuse."""

import os
import re
import signal
import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest
import yaml
from tools.two_rovers import ARRAY, COMMANDS, DOMAIN, MANAGER, STATES, tool_of_two_rovers
from wires.ros_client import while_running
from wires.zenoh_peer import free_port

from drake_twin.__main__ import TOOLS
from drake_twin.messages import TFMessage, time_message, type_store
from drake_twin.messages.transform_tree import TransformTree
from drake_twin.tools import control, param, service, tf_echo, topic
from drake_twin.tools.topic_meters import rate_text
from drake_twin.twin.replay import replay

pytest.importorskip("zenoh")


@pytest.fixture
def tool(capsys, monkeypatch):
    with tool_of_two_rovers(capsys, monkeypatch) as tool:
        yield tool


@pytest.fixture
def twin(tool):
    return tool.twin


@pytest.fixture
def port(tool):
    return tool.port


@pytest.fixture
def refused(tool):
    return tool.refused


def process(port, *words, **more):
    """A tool in a process of its own."""
    program = [sys.executable, "-u", "-m", "drake_twin", *map(str, words), "--router", f"127.0.0.1:{port}"]
    return subprocess.Popen(program, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)


def interrupted(running, lines):
    """Ctrl-C after so many lines; returns all lines."""
    said = [running.stdout.readline() for _ in range(lines)]
    running.send_signal(signal.SIGINT)
    rest, err = running.communicate(timeout=60)
    assert err == ""
    assert running.returncode == 0
    return [*said, *rest.splitlines(keepends=True)]


def test_topics_are_those_of_the_twin(tool, twin):
    _, out, _ = tool(topic, "list", "-t")
    assert out.splitlines() == [f"{name} [{kind}]" for name, kind in sorted(twin.graph.topics().items())]
    assert tool(topic, "list", "-c") == (0, f"{len(twin.graph.topics())}\n", "")
    published, subscribed = tool(topic, "list", "-v")[1].removesuffix("\n\n").split("\n\n")
    assert published.startswith("Published topics:\n * /clock [rosgraph_msgs/msg/Clock] 1 publisher\n")
    assert f" * {COMMANDS} [{ARRAY}] 1 subscriber\n" in f"{subscribed}\n"
    assert subscribed.startswith("Subscribed topics:\n")
    hidden = set(tool(topic, "list", "--include-hidden-topics")[1].split()) - set(twin.graph.topics())
    assert hidden
    assert all("/_action/" in name for name in hidden)


def test_a_message_is_echoed(tool):
    code, out, _ = tool(topic, "echo", STATES, "--once")
    message, end = out.rsplit("---", 1)
    assert (code, end) == (0, "\n")
    fields = yaml.safe_load(message)
    assert [*fields] == ["header", "name", "position", "velocity", "effort"]
    assert fields["name"][0] == "robot_1_front_left_wheel_joint"
    assert len(fields["position"]) == 4
    _, out, _ = tool(topic, "echo", STATES, "--once", "--field", "header.frame_id")
    assert out == "base_link\n---\n"
    _, out, _ = tool(topic, "echo", "robot_1/joint_states", "sensor_msgs/JointState", "--once", "--flow-style")
    assert out.startswith("{header: {stamp: {sec: ")


def test_a_late_joiner_gets_the_description(tool, twin):
    _, out, _ = tool(topic, "echo", "/robot_1/robot_description", "--once", "-f", "--field", "data")
    assert out == f"{twin.built.plans[0].description.text}\n---\n"
    _, out, _ = tool(topic, "echo", "/robot_1/robot_description", "--once", "-l", 5)
    assert out == "data: <?xml...\n---\n"


def test_messages_of_a_topic_until_ctrl_c(twin, port):
    """Twelve joint states of 100 Hz are on its grid, without a gap."""
    environment = os.environ | {"ROS_DOMAIN_ID": str(DOMAIN)}
    running = process(port, "topic", "echo", STATES, "--field", "header.stamp.nanosec", env=environment)
    lines = while_running(twin, lambda: interrupted(running, 24))
    assert set(lines[1::2]) == {"---\n"}
    stamps = [int(line) for line in lines[0:24:2]]
    assert {(after - before) % 1_000_000_000 for before, after in pairwise(stamps[1:])} == {10_000_000}


def test_the_rate_of_a_topic_until_ctrl_c(twin, port):
    environment = os.environ | {"ROS_DOMAIN_ID": str(DOMAIN)}
    running = process(port, "topic", "hz", "/clock", env=environment)
    lines = while_running(twin, lambda: interrupted(running, 2))
    figures = r"average rate: \d+\.\d{3}\n\tmin: \d+\.\d{3}s max: \d+\.\d{3}s std dev: \d+\.\d{5}s window: \d+\n"
    assert re.fullmatch(f"({figures})+", "".join(lines))


@pytest.mark.parametrize("lines", [1, 20, 200, 800])
def test_ctrl_c_while_it_starts_prints_nothing(lines):
    """The moments are counted in what Python says of its imports."""
    words = ("topic", "hz", "/clock", "--router", f"127.0.0.1:{free_port()}")
    program = [sys.executable, "-v", "-m", "drake_twin", *words]
    running = subprocess.Popen(program, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for line in running.stderr:
        if "drake_twin/program" in line:  # Ctrl-C has its meaning by then
            break
    for _ in range(lines):
        running.stderr.readline()
    running.send_signal(signal.SIGINT)
    out, err = running.communicate(timeout=60)
    assert out == ""
    assert "Traceback" not in err
    assert running.returncode in (-signal.SIGINT, 130, 2)  # 2: no router answered before


def test_a_reader_that_leaves_ends_it(twin, port):
    environment = os.environ | {"ROS_DOMAIN_ID": str(DOMAIN)}
    running = process(port, "topic", "echo", "/clock", env=environment)

    def read():
        running.stdout.readline()
        running.stdout.close()
        return running.wait(timeout=60), running.stderr.read()

    assert while_running(twin, read) == (0, "")


def test_rates_by_hand():
    """The mean of 10, 20 and 30 ms is 50 Hz; their deviation is the square root of 200/3 ms²."""
    assert rate_text([10_000_000, 20_000_000, 30_000_000]) == (
        "average rate: 50.000\n\tmin: 0.010s max: 0.030s std dev: 0.00816s window: 3"
    )


def test_a_published_command_is_the_twins_and_is_replayed(tool, twin):
    twin.recorder.begin()
    code, out, _ = tool(topic, "pub", "--times", 3, "-r", 50, "-p", 2, COMMANDS, ARRAY, "{data: [2, 2, 2.5, 2]}")
    assert code == 0
    assert out == (
        "publisher: beginning loop\npublishing #2: std_msgs.msg.Float64MultiArray(layout="
        "std_msgs.msg.MultiArrayLayout(dim=[], data_offset=0), data=[2.0, 2.0, 2.5, 2.0])\n\n"
    )
    twin.advance_to(twin.time + 0.2)
    assert list(twin.graph.command(COMMANDS).data) == [2.0, 2.0, 2.5, 2.0]
    assert [call.name for call in twin.recorder.recording().calls].count("publish") == 3
    with replay(twin.recorder.recording()) as again:
        assert again.state_sha256() == twin.state_sha256()


def test_a_topic_without_subscribers_is_published_where_nobody_is_waited_for(tool):
    code, out, _ = tool(topic, "pub", "-1", "-w", 0, "/chatter", "std_msgs/String", "{data: hello}")
    assert code == 0
    assert out == "publisher: beginning loop\npublishing #1: std_msgs.msg.String(data='hello')\n\n"


def test_who_publishes_and_hears_a_topic(tool):
    assert tool(topic, "info", STATES)[1] == (
        "Type: sensor_msgs/msg/JointState\nPublisher count: 1\nSubscription count: 0\n"
    )
    _, out, _ = tool(topic, "info", "-v", COMMANDS)
    assert "Node name: forward_velocity_controller\nNode namespace: /robot_1\n" in out
    assert "Endpoint type: SUBSCRIPTION" in out
    assert re.search(r"\nGID: ([0-9a-f]{2}\.){15}[0-9a-f]{2}\nQoS profile:\n", out)
    assert out.partition("QoS profile:\n")[2] == (  # as rclpy's TopicEndpointInfo
        "  Reliability: RELIABLE\n  History (Depth): KEEP_LAST (10)\n  Durability: VOLATILE\n  Lifespan: Infinite\n"
        "  Deadline: Infinite\n  Liveliness: AUTOMATIC\n  Liveliness lease duration: Infinite\n\n"
    )
    assert "Durability: TRANSIENT_LOCAL" in tool(topic, "info", "-v", "/tf_static")[1]


def test_controllers_are_listed_and_switched(tool, twin):
    _, out, _ = tool(control, "list_controllers", *MANAGER)
    listed = [line.split() for line in out.splitlines()]
    manager = twin.control.manager("robot_1")
    assert listed == [[item.name, item.type, item.state] for item in manager.list_controllers()]
    both = tool(control, "list_controllers")[1]
    assert [line for line in both.splitlines() if line.endswith(":")] == [
        "/robot_1/controller_manager:",
        "/robot_2/controller_manager:",
    ]
    code, _, err = tool(control, "switch_controllers", *MANAGER, "--deactivate", "forward_velocity_controller")
    assert (code, err) == (0, "")
    assert manager.states["forward_velocity_controller"] == "inactive"
    assert twin.control.manager("robot_2").states["forward_velocity_controller"] == "active"
    code, _, err = tool(control, "switch_controllers", *MANAGER, "--strict", "--activate", "nobody")
    assert code == 1
    assert "controller 'nobody' is not loaded" in err


def test_interfaces_are_listed(tool):
    _, out, _ = tool(control, "list_hardware_interfaces", *MANAGER)
    commands, states = out.removeprefix("command interfaces\n").split("state interfaces\n")
    assert "\trobot_1_front_left_wheel_joint/velocity [available] [claimed]\n" in commands
    assert "\trobot_1_rear_right_wheel_joint/position\n" in states
    assert " [double]\n" in tool(control, "list_hardware_interfaces", *MANAGER, "-v")[1]
    _, out, _ = tool(control, "list_controllers", *MANAGER, "--claimed-interfaces")
    assert "\t\trobot_1_front_left_wheel_joint/velocity\n" in out


def test_services_are_listed_and_called(tool, twin):
    _, out, _ = tool(service, "list", "-t")
    assert "/drake_twin/reset_simulation [simulation_interfaces/srv/ResetSimulation]" in out.splitlines()
    kind = "simulation_interfaces/srv/SetSimulationState"
    code, out, _ = tool(service, "call", "/drake_twin/set_simulation_state", kind, "{state: {state: 2}}")
    assert code == 0
    assert out == (
        "requester: making request: simulation_interfaces.srv.SetSimulationState_Request("
        "state=simulation_interfaces.msg.SimulationState(state=2))\n\n"
        "response:\nsimulation_interfaces.srv.SetSimulationState_Response("
        "result=simulation_interfaces.msg.Result(result=1, error_message=''))\n\n"
    )
    assert twin.clock.paused


def test_parameters(tool, twin):
    node = "/robot_1/controller_manager"
    assert tool(param, "get", node, "update_rate")[1] == "Integer value is: 100\n"
    assert tool(param, "get", node, "use_sim_time", "--hide-type")[1] == "True\n"
    assert "  update_rate\n" in tool(param, "list", node)[1]
    assert f"{node}:\n" in tool(param, "list")[1]
    strictness = "defaults.switch_controller.strictness"
    assert tool(param, "set", node, strictness, "strict")[:2] == (0, "Set parameter successful\n")
    assert tool(param, "get", node, strictness)[1] == "String value is: strict\n"
    assert tool(param, "set", node, strictness, "best_effort")[0] == 0
    code, _, err = tool(param, "set", node, "update_rate", 50)
    assert code == 1
    assert err.startswith("Setting parameter failed: ")
    for value in (
        "[50]",
        "[]",
        "[50, a]",
        "fifty",
    ):  # of other types: a list of one, of none and of several types, text
        code, _, err = tool(param, "set", node, "update_rate", value)
        assert (code, err.partition(": ")[0]) == (1, "Setting parameter failed"), value


def test_a_transform_is_the_base_pose(tool, twin):
    """A rover that has turned and driven; the paused twin's state is the source of the numbers."""
    twin.publish(COMMANDS, [1.0, 4.0, 1.0, 4.0])
    twin.advance_to(2.0)
    _, out, _ = tool(tf_echo, "world", "robot_1_base_link", "--once")
    seconds = float(re.search(r"At time (\d+\.\d{9})\n", out)[1])
    assert 2.0 <= seconds <= twin.time
    twin.publish(COMMANDS, [0.0] * 4)
    tree = TransformTree()
    for name, is_static in (("/tf", False), ("/tf_static", True)):
        tree.add(twin.latest(name), is_static=is_static)
    x, y, z, *wxyz = twin.robot_state("robot_1").base_pose
    pose = tree.look_up("world", "robot_1_base_link")
    np.testing.assert_allclose(pose.translation, [x, y, z], atol=1e-12)
    np.testing.assert_allclose(pose.rotation.as_quat(canonical=True), np.roll(wxyz, -1) * np.sign(wxyz[0]), atol=1e-12)
    back = tree.look_up("robot_1_base_link", "world")
    np.testing.assert_allclose(back.rotation.apply([x, y, z]) + back.translation, 0, atol=1e-12)


def transform(parent, child, xyz, quaternion, seconds=0.0):
    types = type_store().types
    stamp, name = time_message(seconds), "geometry_msgs/msg/{}".format
    header = types["std_msgs/msg/Header"](stamp, parent)
    pose = types[name("Transform")](types[name("Vector3")](*xyz), types[name("Quaternion")](*quaternion))
    return types[name("TransformStamped")](header, child, pose)


def test_a_transform_by_hand():
    """B stands 1 m along x of A and is turned by 90° about z; C is 1 m along B's x, that is, along A's y."""
    tree = TransformTree()
    half = 0.5**0.5
    tree.add(TFMessage([transform("a", "b", (1, 0, 0), (0, 0, half, half), 2.5)]), is_static=False)
    tree.add(TFMessage([transform("b", "c", (1, 0, 0), (0, 0, 0, 1))]), is_static=True)
    assert tf_echo.transform_text(tree.look_up("a", "c")) == (
        "At time 2.500000000\n- Translation: [1.000, 1.000, 0.000]\n"
        "- Rotation: in Quaternion [0.000, 0.000, 0.707, 0.707]\n"
        "- Rotation: in RPY (radian) [0.000, 0.000, 1.571]\n- Rotation: in RPY (degree) [0.000, 0.000, 90.000]\n"
        "- Matrix:\n  0.000 -1.000  0.000  1.000\n  1.000  0.000  0.000  1.000\n  0.000  0.000  1.000  0.000\n"
        "  0.000  0.000  0.000  1.000"
    )


def test_frames_that_do_not_fit(refused):
    tree = TransformTree()
    tree.add(TFMessage([transform("a", "b", (1, 0, 0), (0, 0, 0, 1))]), is_static=True)
    tree.add(TFMessage([transform("c", "d", (1, 0, 0), (0, 0, 0, 1))]), is_static=True)
    with pytest.raises(Exception, match="no transforms connect 'b' in 'a' with 'd' in 'c'"):
        tree.look_up("b", "d")
    tree.add(TFMessage([transform("b", "a", (1, 0, 0), (0, 0, 0, 1))]), is_static=True)
    with pytest.raises(Exception, match="is above itself"):
        tree.look_up("a", "b")
    assert "unknown frame 'robot_1_base_lin'. Did you mean 'robot_1_base_link'?" in refused(
        tf_echo, "world", "robot_1_base_lin"
    )


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ((topic, "ech"), "has no verb 'ech'. Did you mean 'echo'?"),
        (
            (topic, "echo", "/robot_1/joint_state"),
            "unknown topic '/robot_1/joint_state'. Did you mean '/robot_1/joint_st",
        ),
        (
            (topic, "echo", STATES, "std_msgs/msg/String"),
            "has the type sensor_msgs/msg/JointState, not std_msgs/msg/St",
        ),
        (
            (topic, "echo", STATES, "std_msgs/msg/Strin"),
            "the type std_msgs/msg/Strin of /robot_1/joint_states is not known",
        ),
        ((topic, "echo", STATES, "--field", "header.stam"), "unknown field 'stam'. Did you mean 'stamp'?"),
        ((topic, "echo", STATES, "-l", -1), "--truncate-length -1 is negative"),
        ((topic, "info", "/nothing"), "unknown topic '/nothing'"),
        ((topic, "hz", STATES, "-w", 0), "--window 0: the average is of at least one message"),
        ((topic, "pub", "-1", STATES, ARRAY), "unknown subscribed topic '/robot_1/joint_states'"),
        ((topic, "pub", "-1", COMMANDS[:-1], ARRAY), f"Did you mean '{COMMANDS}'?"),
        ((topic, "pub", "-1", COMMANDS, "std_msgs/msg/String"), f"has the type {ARRAY}, not std_msgs/msg/String"),
        ((topic, "pub", "-1", COMMANDS, ARRAY, "{dat: [1]}"), "has no field dat; it has layout, data"),
        ((topic, "pub", "-1", COMMANDS, ARRAY, "{data: [1, x]}"), "data[1]: 'x' is not a float64"),
        ((topic, "pub", "-1", COMMANDS, ARRAY, "{data: [1"), "is not valid YAML"),
        ((topic, "pub", "--times=-1", COMMANDS, ARRAY), "--times and --wait-matching-subscriptions are whole numbers"),
        ((topic, "pub", "-r", 0, COMMANDS, ARRAY), "invalid positive value: '0'"),
        ((service, "call", "/pause_physic", "std_srvs/srv/Empty"), "Did you mean '/pause_physics'?"),
        (
            (service, "call", "/pause_physics", "std_srvs/srv/Trigger"),
            "has the type std_srvs/srv/Empty, not std_srvs/srv/Tr",
        ),
        ((service, "call", "/pause_physics", "std_srvs/srv/Empty", "{a: 1}"), "has no field a"),
        ((control, "list_controllers", "-c", "/robot_3/controller_manager"), "unknown controller manager"),
        ((control, "switch_controllers", "--activate", "x"), "which controller manager is meant? Give -c"),
        ((control, "switch_controllers", *MANAGER), "name the controllers: --activate NAME"),
        ((param, "get", "/robot_1/nobody", "x"), "no node '/robot_1/nobody' has parameters"),
        ((param, "get", "/robot_1/controller_manager", "update"), "has no parameter 'update'"),
    ],
)
def test_what_is_refused(refused, words, text):
    assert text in refused(*words)


@pytest.mark.parametrize("name", TOOLS)
def test_a_tool_starts_without_drake(name):
    program = (
        f"import sys; from drake_twin.tools.{name} import main; import drake_twin.client, drake_twin.messages.text\n"
    )
    program += "import drake_twin.messages.transform_tree; from drake_twin.messages.interface_types import type_hash\n"
    program += (
        "type_hash('std_msgs/msg/String'); assert not [name for name in sys.modules if name.startswith('pydrake')]"
    )
    subprocess.run([sys.executable, "-c", program], check=True)


@pytest.mark.parametrize(
    "words", [("topic", "list"), ("service", "list"), ("control", "list_controllers"), ("param", "list")]
)
def test_no_router(words):
    running = process(free_port(), *words)
    out, err = running.communicate(timeout=60)
    assert (running.returncode, out) == (2, "")
    assert err.startswith("error: no Zenoh router answers at 127.0.0.1:")
    assert "start a twin with: python -m drake_twin.run … --ros zenoh" in err


def test_another_domain(twin, port):
    environment = os.environ | {"ROS_DOMAIN_ID": "7"}
    running = process(port, "topic", "list", env=environment)
    _, err = while_running(twin, lambda: running.communicate(timeout=60))
    assert running.returncode == 2
    assert "no twin and no node is on the ROS 2 graph in domain 7; there are in domain 6: set ROS_DOMAIN_ID" in err


def test_help():
    run = subprocess.run([sys.executable, "-m", "drake_twin", "topic"], capture_output=True, text=True, check=True)
    assert "  echo " in run.stdout
