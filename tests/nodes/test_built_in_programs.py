"""``twist_mux``, ``topic_tools`` and ``twist_stamper``, against their sources' rules."""

import os
import pty
import select
import sys
import termios
from itertools import pairwise

import pytest
from conftest import rovers
from node_runs import script

from drake_twin import Twin
from drake_twin.builder.launch_file import launch_file_scenario
from drake_twin.description.built_in_programs import built_in_programs
from drake_twin.findings import Kind
from drake_twin.nodes.nodes import Nodes
from drake_twin.scenario import NodeProgram

EAR = """
import sys, rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist, TwistStamped

class Ear(Node):
    def __init__(self):
        super().__init__("ear")
        kind = TwistStamped if sys.argv[1] == "stamped" else Twist
        self.create_subscription(kind, sys.argv[2], self.hear, 10)

    def hear(self, message):
        twist = getattr(message, "twist", message)
        print(f"{self.get_clock().now().nanoseconds * 1e-9:.3f} {twist.linear.x:g}", flush=True)

rclpy.init()
rclpy.spin(Ear())
"""
VOICE = """
import sys, rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist, TwistStamped
from std_msgs.msg import Bool

class Voice(Node):
    '''Publishes a value on a topic, from a time to another one, at 10 Hz.'''
    def __init__(self):
        super().__init__("voice")
        kind, topic, value, self.start, self.end = sys.argv[1:6]
        self.kind, self.value = {"twist": Twist, "stamped": TwistStamped, "bool": Bool}[kind], float(value)
        self.publisher = self.create_publisher(self.kind, topic, 10)
        self.create_timer(0.1, self.say)

    def say(self):
        now = self.get_clock().now().nanoseconds * 1e-9
        if float(self.start) - 1e-6 <= now <= float(self.end) + 1e-6:
            message = self.kind()
            if self.kind is Bool:
                message.data = bool(self.value)
            else:
                getattr(message, "twist", message).linear.x = self.value
            self.publisher.publish(message)

rclpy.init()
rclpy.spin(Voice())
"""
MUX = """/**: {ros__parameters: {use_stamped: false,
  topics: {keys: {topic: keys, timeout: 0.25, priority: 100}, nav: {topic: nav, timeout: 0.25, priority: 10},
           never: {topic: never_heard, timeout: 0.25, priority: 0}},
  locks: {stop: {topic: stop, timeout: 0.0, priority: 50}}}}
"""


@pytest.fixture
def run(tmp_path, capfd):
    """Runs programs for 2 s; returns what the ear heard: (time, value)."""
    ear, voice = script(tmp_path, "ear.py", EAR), script(tmp_path, "voice.py", VOICE)

    def run_(program, heard, *said, kind="twist"):
        voices = [NodeProgram(str(voice), arguments=tuple(map(str, item))) for item in said]
        with rovers(1, time_step=0.01).build() as twin:
            nodes = Nodes(twin, [program, NodeProgram(str(ear), arguments=(kind, heard)), *voices])
            twin.advance_to(2.0)
            nodes.close()
            assert twin.more_findings == []
        lines = capfd.readouterr().out.splitlines()
        return [tuple(map(float, line.split())) for line in lines if line[:1].isdigit()]

    return run_


@pytest.fixture
def mux(tmp_path):
    (tmp_path / "mux.yaml").write_text(MUX)
    arguments = ("--ros-args", "--params-file", str(tmp_path / "mux.yaml"), "-r", "cmd_vel_out:=/out")
    return NodeProgram("twist_mux", "twist_mux", arguments)


def values(heard, start, end):
    return {value for time, value in heard if start < time < end}


def test_the_highest_priority_goes_on_until_it_has_been_silent_for_its_timeout(run, mux):
    """topic_handle.hpp:102 (hasExpired), twist_mux.cpp:162 (hasPriority)."""
    heard = run(mux, "/out", ("twist", "/nav", 1, 0, 2), ("twist", "/keys", 7, 0.5, 1.0))
    assert values(heard, 0.15, 0.5) == {1}
    assert values(heard, 0.52, 1.05) == {7}
    assert values(heard, 1.05, 1.23) == set()
    assert values(heard, 1.35, 2.0) == {1}


def test_a_lock_holds_back_what_has_a_lower_priority(run, mux):
    """twist_mux.cpp:138 (getLockPriority), topic_handle.hpp:180 (isMasked)."""
    said = ("twist", "/nav", 1, 0, 2), ("bool", "/stop", 1, 0.5, 0.5), ("bool", "/stop", 0, 1.0, 1.0)
    heard = run(mux, "/out", *said)
    assert values(heard, 0.15, 0.5) == {1}
    assert values(heard, 0.55, 1.0) == set()
    assert values(heard, 1.15, 2.0) == {1}
    assert values(run(mux, "/out", *said, ("twist", "/keys", 7, 0, 2)), 0.55, 1.0) == {7}


def test_a_priority_of_zero_never_goes_on(run, mux):
    """twist_mux.cpp:170: the highest priority is above zero."""
    assert run(mux, "/out", ("twist", "/never_heard", 1, 0, 2)) == []


def test_without_use_stamped_jazzys_default_is_twists_with_a_header(run, tmp_path):
    (tmp_path / "mux.yaml").write_text(MUX.replace("use_stamped: false,", ""))
    arguments = ("--ros-args", "--params-file", str(tmp_path / "mux.yaml"), "-r", "cmd_vel_out:=/out")
    program = NodeProgram("twist_mux", "twist_mux", arguments)
    assert values(run(program, "/out", ("stamped", "/nav", 1, 0, 2), kind="stamped"), 0.15, 2.0) == {1}


def test_a_relay_passes_on_what_it_finds(run):
    """relay_node.cpp:31: the output is the input's name with _relay unless it is given."""
    program = NodeProgram("relay", "topic_tools", ("--ros-args", "-p", "input_topic:=/nav"))
    assert values(run(program, "/nav_relay", ("twist", "/nav", 3, 0, 2)), 0.3, 2.0) == {3}
    program = NodeProgram("relay", "topic_tools", ("/nav", "/other"))
    assert values(run(program, "/other", ("twist", "/nav", 3, 0, 2)), 0.3, 2.0) == {3}


def test_a_throttle_passes_on_so_many_a_second(run):
    """throttle_node.cpp:76: after each message it waits for the period; 10 Hz at 2 Hz is each fifth."""
    more = ("-p", "throttle_type:=messages", "-p", "msgs_per_sec:=2.0")
    program = NodeProgram("throttle", "topic_tools", ("--ros-args", "-p", "input_topic:=/nav", *more))
    times = [time for time, _ in run(program, "/nav_throttle", ("twist", "/nav", 3, 0, 2))]
    assert len(times) == 3
    assert [later - time for time, later in pairwise(times)] == pytest.approx([0.5, 0.5], abs=0.02)


def test_a_throttle_takes_its_command_line(run):
    """throttle.cpp:24: throttle messages INPUT RATE [OUTPUT]."""
    program = NodeProgram("throttle", "topic_tools", ("messages", "/nav", "2.0", "/slow"))
    assert len(run(program, "/slow", ("twist", "/nav", 3, 0, 2))) == 3


def test_so_many_are_dropped(run):
    """drop_node.cpp:45: the first X of each Y; drop.cpp:26: drop INPUT X Y [OUTPUT]."""
    program = NodeProgram("drop", "topic_tools", ("/nav", "2", "3"))
    times = [time for time, _ in run(program, "/nav_drop", ("twist", "/nav", 3, 0.5, 2))]
    assert len(times) == 5
    assert [later - time for time, later in pairwise(times)] == pytest.approx([0.3] * 4, abs=0.02)


def test_all_are_delayed(run):
    """delay_node.cpp:43; delay.cpp:26: delay INPUT DELAY [OUTPUT]."""
    program = NodeProgram("delay", "topic_tools", ("/nav", "0.45", "/late"))
    heard = run(program, "/late", ("twist", "/nav", 3, 0.5, 1.0))
    assert [time for time, _ in heard] == pytest.approx([0.5 + 0.45 + 0.1 * index for index in range(6)], abs=0.04)


def test_what_is_dropped_must_be_said(tmp_path):
    with rovers(1).build() as twin:
        nodes = Nodes(twin, [NodeProgram("drop", "topic_tools", ("/nav", "2"))])
        twin.advance_to(0.1)
        nodes.close()
        assert "the parameter Y is not set" in twin.more_findings[0].what


def test_stamps_are_added_and_left_out(run):
    remap = ("--ros-args", "-r", "cmd_vel_in:=/in", "-r", "cmd_vel_out:=/out")
    stamper = NodeProgram("twist_stamper", "twist_stamper", remap)
    assert values(run(stamper, "/out", ("twist", "/in", 3, 0, 2), kind="stamped"), 0.2, 2.0) == {3}
    unstamper = NodeProgram("twist_unstamper", "twist_stamper", remap)
    assert values(run(unstamper, "/out", ("stamped", "/in", 3, 0, 2)), 0.2, 2.0) == {3}


def test_each_program_is_there():
    scans = "depthimage_to_laserscan", "pointcloud_to_laserscan", "image_proc", "robot_localization"
    drives = "teleop_twist_joy", "teleop_twist_keyboard", "topic_tools", "turtlesim", "twist_mux", "twist_stamper"
    for package in ("joint_state_publisher", *scans, *drives):
        programs = built_in_programs(package)
        assert programs
        assert all(program.file.is_file() for program in programs.values())
    assert built_in_programs("nav2_planner") == {}


def test_a_launch_file_starts_one_although_its_package_is_not_there(tmp_path):
    inertia = "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
    urdf = f"<robot name='r'><link name='base'><inertial><mass value='1'/>{inertia}</inertial></link></robot>"
    (tmp_path / "r.urdf").write_text(urdf)
    (tmp_path / "all.launch.py").write_text(f"""
from launch import LaunchDescription
from launch_ros.actions import Node

def generate_launch_description():
    return LaunchDescription([
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{{"robot_description": open({str(tmp_path / "r.urdf")!r}).read()}}]),
        Node(package="ros_gz_sim", executable="create", arguments=["-topic", "robot_description", "-name", "r"]),
        Node(package="twist_mux", executable="twist_mux", parameters=[{{"topics.a.topic": "a", "topics.a.timeout": 0.5,
             "topics.a.priority": 10}}], remappings=[("cmd_vel_out", "cmd_vel")]),
        Node(package="twist_mux", executable="twist_marker"),
    ])
""")
    scenario = launch_file_scenario(tmp_path / "all.launch.py").scenario
    (program,) = scenario.nodes
    assert (program.package, program.executable) == ("twist_mux", "twist_mux")
    assert "cmd_vel_out:=cmd_vel" in program.arguments
    (lost,) = [item.what for item in scenario.findings if item.kind is Kind.NOT_STARTED]
    assert lost.startswith("twist_mux/twist_marker (")
    with Twin(scenario) as twin:
        nodes = Nodes(twin)
        twin.advance_to(0.1)
        assert "/a" in nodes.graph.receptions
        nodes.close()
        assert twin.more_findings == []


def press(keys, ear, *arguments, program="teleop_twist_keyboard", package="teleop_twist_keyboard", end=1.0, more=()):
    """Press keys in a terminal at their times, while an ear hears what becomes of them."""
    ours, theirs = pty.openpty()
    with open(theirs, encoding="utf-8") as terminal, pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "stdin", terminal)
        before = termios.tcgetattr(terminal)
        with rovers(1, time_step=0.01).build() as twin:
            nodes = Nodes(twin, [ear, *more, NodeProgram(program, package, arguments)])
            for time, key in keys:
                twin.advance_to(time)
                os.write(ours, key)
                assert select.select([terminal], [], [], 10)[0], "the terminal has passed the key on"
            twin.advance_to(end)
            nodes.close()
            assert twin.more_findings == []
        assert termios.tcgetattr(terminal) == before
    os.close(ours)


@pytest.mark.parametrize("kind", ["twist", "stamped"])
def test_keys_become_twists(tmp_path, capfd, kind):
    """teleop_twist_keyboard.py:73, 94: i is forward at 0.5 m/s, w a tenth faster, k stops."""
    ear = NodeProgram(str(script(tmp_path, "ear.py", EAR)), arguments=(kind, "/cmd_vel"))
    more = ("--ros-args", "-p", "stamped:=true") if kind == "stamped" else ()
    press([(0.195, b"i"), (0.395, b"w"), (0.595, b"k"), (0.795, b"i")], ear, *more)
    heard = [line.split()[1] for line in capfd.readouterr().out.splitlines() if line[:1].isdigit()]
    assert heard == ["0.5", "0.55", "0", "0.55"]


TURTLE_EAR = """
import rclpy
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("ear")
node.create_subscription(Pose, "/turtle1/pose", lambda pose: setattr(node, "pose", pose), 10)
node.create_timer(1.2, lambda: print(f"{node.pose.x:.2f} {node.pose.theta:.2f}", flush=True))
rclpy.spin(node)
"""


def test_keys_drive_a_turtle(tmp_path, capfd):
    """teleop_turtle_key.cpp: an arrow is 2 m/s or 2 rad/s, which lasts for 1 s; a letter is a heading, f stops."""
    ear = NodeProgram(str(script(tmp_path, "ear.py", TURTLE_EAR)))
    keys = [(0.015, b"\x1b[A"), (1.215, b"e"), (2.015, b"f"), (2.415, b"\x1b[D"), (3.595, b"q")]
    given = {"program": "turtle_teleop_key", "package": "turtlesim", "end": 3.7}
    press(keys, ear, more=[NodeProgram("turtlesim_node", "turtlesim")], **given)
    lines = [line for line in capfd.readouterr().out.splitlines() if line[:1].isdigit()]
    (x, first), (_, second), (_, third) = (map(float, line.split()) for line in lines)
    assert (x, first) == (pytest.approx(5.54 + 2.0, abs=0.05), 0.0)
    assert second == pytest.approx(0.8, abs=0.05)
    assert third == pytest.approx(second + 2.0, abs=0.05)


def test_without_a_terminal_there_are_no_keys(monkeypatch):
    with open(os.devnull, encoding="utf-8") as nothing, rovers(1, time_step=0.01).build() as twin:
        monkeypatch.setattr(sys, "stdin", nothing)
        nodes = Nodes(twin, [NodeProgram("teleop_twist_keyboard", "teleop_twist_keyboard")])
        twin.advance_to(0.1)
        nodes.close()
        (finding,) = twin.more_findings
    assert "standard input is not a terminal" in finding.what
