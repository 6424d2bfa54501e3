"""Loops that look again and again whether something has changed let others have their turns; runs repeat."""

import os
import subprocess
import sys

import pytest
from node_runs import COMMANDS, HEAD, lines, running, script

from drake_twin.nodes.polls import compiled

SPINNER = f"""
import threading, time
{HEAD}
from sensor_msgs.msg import JointState


class Listener(Node):
    def __init__(self):
        super().__init__("my")
        self.data, self.count, self.lock, self.event = None, 0, threading.Lock(), threading.Event()
        self.create_subscription(JointState, "/robot_1/joint_states", self.heard, 10)

    def heard(self, message):
        self.count += 1
        if self.count > 4:
            self.data = message
            self.event.set()
            globals()["flag"] = True


flag = False
rclpy.init()
node = Listener()
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
"""
LOOPS = {
    "a name": "while not flag: pass",
    "an attribute": "while node.data is None:\n    pass",
    "continue": "while True:\n    if not flag:\n        continue\n    break",
    "what is done then": "while True:\n    if node.data is not None:\n        node.data.name\n        break",
    "an event": "while not node.event.is_set():\n    print(end='')",
    "a lock": "while True:\n    with node.lock:\n        if node.data is not None:\n            break",
    "a loop in a loop": "while True:\n    if flag:\n        while not flag: pass\n        break",
    "a value": "missing = True\nwhile missing:\n    data = node.data\n    missing, other = data is None, flag",
    "a for": "while True:\n    for number in (1, 2):\n        if flag: number = 9\n    if flag: break",
    "a function": "def wait():\n    while True:\n        if flag:\n            return\nwait()",
    "a try": "try:\n    while True:\n        if flag: raise KeyError\nexcept KeyError:\n    pass",
}


@pytest.mark.parametrize("loop", LOOPS.values(), ids=LOOPS)
def test_a_loop_that_polls_lets_another_thread_spin(tmp_path, capsys, loop):
    file = script(tmp_path, "f.py", f"{SPINNER}\n{loop}\nprint(node.count, round(time.monotonic(), 3))\n")
    with running(file) as twin:
        twin.advance_to(0.1)
        assert twin.findings == ()
    assert lines(capsys)[-1] == "5 0.04"  # joint states come every 0.01 s, first at 0.001 s


def test_a_loop_in_a_module_of_the_program_polls_too(tmp_path, capsys):
    script(tmp_path, "mine.py", "def wait(node):\n    while node.data is None:\n        pass\n")
    file = script(tmp_path, "f.py", f"{SPINNER}\nimport mine\nmine.wait(node)\nprint(node.count)\n")
    with running(file) as twin:
        twin.advance_to(0.1)
    assert lines(capsys) == ["5"]
    assert [each.name for each in tmp_path.rglob("*.pyc")] == []


def test_a_loop_that_nothing_ends_is_a_failure_at_once(tmp_path, capsys):
    file = script(tmp_path, "f.py", "print('begins')\nwhile True:\n    pass\n")
    with running(file) as twin:
        twin.advance_to(0.001)
        why = "it is in a loop without end, as it has no other thread that could end it, and is ended"
        assert [item.what for item in twin.findings] == [f"node f.py: {why} ({file}:3)"]
    assert lines(capsys) == ["begins"]


def test_a_loop_that_ctrl_c_ends_goes_on_until_then(tmp_path, capsys):
    handle = "import signal\ngoing = True\ndef stop(*_):\n    global going\n    going = False\n"
    text = f"{handle}signal.signal(signal.SIGINT, stop)\nwhile going: pass\nprint('ended')\n"
    with running(script(tmp_path, "f.py", text)) as twin:
        twin.advance_to(0.1)
        assert twin.findings == ()
        assert lines(capsys) == []
    assert lines(capsys) == ["ended"]


def test_a_thread_that_keeps_others_waiting_is_named(tmp_path, caplog, monkeypatch):
    monkeypatch.setattr("drake_twin.nodes.turns._WORTH_SAYING", 0.1)
    text = "import threading, time\nthreading.Thread(target=time.sleep, args=(0.01,)).start()\ncount = 0\n"
    file = script(tmp_path, "f.py", f"{text}while count < 20_000_000:\n    count += 1\n")
    with running(file) as twin:
        twin.advance_to(0.1)
        assert twin.findings == ()
    why = "computes without a sleep or a spin, and its other threads wait until it has done so"
    assert caplog.text.count(why) == 1
    assert f"node f.py {why} ({file}:" in caplog.text


@pytest.mark.parametrize(
    "loop",
    [
        "while publisher.get_subscription_count() == 0:\n    node.get_logger().info('none', throttle_duration_sec=1.0)",
        "while time.time() - start < 0.01: pass",
        "while node.get_clock().now() - start < Duration(seconds=0.01): pass",
    ],
)
def test_a_look_at_the_graph_or_at_the_time_is_one_a_step(tmp_path, capsys, loop):
    head = f"import time\n{HEAD}from rclpy.duration import Duration\nrclpy.init()\nnode = rclpy.create_node('a')\n"
    head += "publisher, looks = node.create_publisher(String, 'b', 1), 0\n"
    head += f"start = {'time.time()' if 'time.time' in loop else 'node.get_clock().now()'}\n"
    head += "node.create_timer(0.01, lambda: node.create_subscription(String, 'b', print, 1))\n"
    head += "import threading\nthreading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()\n"
    head += "class Looks:\n    def __len__(self):\n        global looks\n        looks += 1\n        return 1\n"
    head += "counted = Looks()\n"
    file = script(tmp_path, "f.py", f"{head}{loop.replace('while ', 'while len(counted) and ')}\nprint(looks)\n")
    with running(file) as twin:
        twin.advance_to(0.05)
        assert twin.findings == ()
    assert 8 <= int(lines(capsys)[-1]) <= 24  # in ten steps, and after turns of the other thread


@pytest.mark.parametrize(
    "loop",
    [
        "while i < 9: i += 1",
        "while step(): pass",
        "while True:\n    i += 1\n    if i > 9: break",
        "while (i := i + 1) < 9: pass",
        "while solver.done is False:\n    solver.step()\n    continue",
    ],
)
def test_a_loop_that_does_something_is_as_it_was(loop):
    assert compiled(loop.encode(), "f.py").co_code == compile(loop, "f.py", "exec").co_code


def test_an_error_in_a_loop_has_its_line():
    code = compiled(b"'a docstring'\nfrom __future__ import annotations\nwhile not flag:\n\n    pass\n", "f.py")
    assert {line for _, _, line in code.co_lines() if line} <= {1, 2, 3, 5}
    assert code.co_names[-1] == "__wait_for_change__"
    with pytest.raises(SyntaxError) as caught:
        compiled(b"while x:\n    pass\nx = = 1\n", "f.py")
    assert (caught.value.filename, caught.value.lineno) == ("f.py", 3)


RUN = """
import sys
from conftest import rovers
builder = rovers(1).node(sys.argv[1])
with builder.build() as twin:
    twin.advance_to(0.5)
    print(twin.state_sha256(), twin.graph.command("/robot_1/forward_velocity_controller/commands").data[0] > 9)
"""


def test_a_run_with_a_polling_thread_has_the_same_state_twice(tmp_path):
    commands = f"publisher = node.create_publisher(Float64MultiArray, {COMMANDS!r}, 10)"
    act = "publisher.publish(Float64MultiArray(data=[float(node.count)] * 4)); node.data = None"
    file = script(
        tmp_path, "f.py", f"{SPINNER}\n{commands}\nwhile True:\n    if node.data is not None:\n        {act}\n"
    )
    folder = os.path.dirname(os.path.dirname(__file__))
    found = [
        subprocess.run(
            [sys.executable, "-c", RUN, str(file)],
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join([folder, *sys.path])},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    ]
    assert found[0] == found[1]
    assert found[0].endswith(" True\n")


def test_a_loop_that_publishes_one_message_until_something_changes_goes_on_step_by_step(tmp_path, capsys):
    """What it waits for comes at 0.041 s: a dozen messages in the first step, and two in each of the others."""
    loop = f"""
publisher, sent = node.create_publisher(Float64MultiArray, "{COMMANDS}", 10), 0
while node.data is None:
    publisher.publish(Float64MultiArray(data=[1.0, 1.0, 1.0, 1.0]))
    sent += 1
print(node.count, round(time.monotonic(), 3), sent < 100)
"""
    with running(script(tmp_path, "f.py", SPINNER + loop)) as twin:
        twin.advance_to(0.1)
    assert lines(capsys)[-1] == "5 0.041 True"


def test_messages_that_differ_are_published_at_once(tmp_path, capsys):
    text = f"""
import time
{HEAD}
rclpy.init()
publisher = Node("my").create_publisher(String, "/words", 10)
for number in range(200):
    publisher.publish(String(data=str(number)))
for _ in range(10):
    publisher.publish(String(data="stop"))
print(time.monotonic())
"""
    with running(script(tmp_path, "f.py", text)) as twin:
        twin.advance_to(0.1)
    assert lines(capsys) == ["0.0"]
