"""Nodes that read from standard input or a terminal, in simulated time."""

import os
import pty
import select
import sys
import termios

import pytest
from conftest import rovers
from node_runs import COMMANDS, HEAD, lines, running, script

from drake_twin.nodes.nodes import Nodes


@pytest.fixture
def pipe(monkeypatch):
    """A file that standard input is: what is written to it, and the function that writes."""
    reading, writing = os.pipe()
    with open(reading, encoding="utf-8") as stream, open(writing, "wb", buffering=0) as end:
        monkeypatch.setattr(sys, "stdin", stream)
        yield end


def test_input_that_is_there_is_read_at_once(tmp_path, capsys, pipe):
    """All of it in the same step, however it is read."""
    pipe.write("1\n2.5\r\nä\nrest\nof\nit".encode())
    pipe.close()
    text = (
        "import sys, time\n"
        "print([float(input('x? ')), float(input()), sys.stdin.read(2), sys.stdin.readline(2), sys.stdin.readline()])\n"
        "print(list(sys.stdin), repr(sys.stdin.read()), time.time())\n"
        "input()\n"
    )
    with running(script(tmp_path, "f.py", text)) as twin:
        twin.advance_to(0.1)
        (finding,) = twin.findings
        assert finding.what.endswith(f"EOFError: EOF when reading a line ({tmp_path / 'f.py'}:4)")
    assert lines(capsys) == [r"x? [1.0, 2.5, 'ä\n', 're', 'st\n']", "['of\\n', 'it'] '' 0.0"]


def test_input_that_comes_later_is_seen_within_ten_milliseconds(tmp_path, capsys, pipe, caplog):
    text = "import sys, time\nfor line in sys.stdin:\n    print(line.strip(), round(time.time(), 3))\n"
    with running(script(tmp_path, "f.py", text)) as twin:
        for time, written in ((0.104, b"a\nb"), (0.204, b"c\n"), (0.3, b"")):
            twin.advance_to(time)
            pipe.write(written)
        twin.advance_to(0.4)
    assert lines(capsys) == ["a 0.11", "bc 0.21"]
    assert caplog.records == []


def test_select_sees_what_is_not_read_yet(tmp_path, capsys, pipe):
    pipe.write(b"ab")
    text = (
        "import select, sys\nread = lambda: sys.stdin.read(1) if select.select([sys.stdin], [], [], 0.1)[0] else ''\n"
    )
    with running(script(tmp_path, "f.py", text + "print([read() for _ in range(3)])\n")) as twin:
        twin.advance_to(0.5)
    assert lines(capsys) == ["['a', 'b', '']"]


def test_what_is_typed_while_the_twin_is_paused_is_read(tmp_path, capsys, pipe):
    with running(script(tmp_path, "f.py", "import time\nprint(input(), time.time())\n")) as twin:
        twin.advance_to(0.1)
        twin.pause()
        pipe.write(b"x\n")
        for callback in twin.frames.callbacks:  # as `Twin.run` does
            callback()
        assert lines(capsys) == ["x 0.1"]


def test_a_node_that_exits_leaves_the_input_to_the_others(tmp_path, capsys, pipe):
    pipe.write(b"mine\n")
    reader = script(tmp_path, "f.py", "import time\ntime.sleep(0.1)\nprint(input())\n")
    with running(script(tmp_path, "g.py", "exit()\n"), reader) as twin:
        twin.advance_to(0.2)
        assert twin.findings == ()
    assert lines(capsys) == ["mine"]


TELEOP = (
    HEAD
    + f"""
import sys
import termios
import tty

KEYS = {{"i": (1, 1), ",": (-1, -1), "j": (-1, 1), "l": (1, -1)}}


def main():
    settings = termios.tcgetattr(sys.stdin)
    rclpy.init()
    node = rclpy.create_node("teleop")
    publisher = node.create_publisher(Float64MultiArray, "{COMMANDS}", 10)
    try:
        while True:
            tty.setraw(sys.stdin.fileno())
            key = sys.stdin.read(1)
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, settings)
            if key == "\\x03":
                break
            left, right = KEYS.get(key, (0, 0))
            publisher.publish(Float64MultiArray(data=[2.0 * left, 2.0 * right] * 2))
    finally:
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, settings)
        print("restored")


main()
"""
)


def drive_by_keys(file, keys, end):
    """Drive a rover from a terminal; return its place, the state's hash and whether the terminal is as before."""
    master, slave = pty.openpty()
    with open(slave, encoding="utf-8") as terminal, pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "stdin", terminal)
        before = termios.tcgetattr(terminal)
        with rovers(1, time_step=0.002).node(file).build() as twin:
            for time, key in keys:
                twin.advance_to(time)
                os.write(master, key)
                assert select.select([terminal], [], [], 10)[0], "the terminal has passed the key on"
            twin.advance_to(end)
            found = twin.entities.state("robot_1").position[0], twin.state_sha256()
            assert twin.findings == ()
        is_restored = termios.tcgetattr(terminal) == before
    os.close(master)
    return *found, is_restored


def test_teleoperation_from_a_terminal(tmp_path, capsys):
    """A key is seen at the next hundredth of a second: forward from 0.2 to 1.2 s, back from 1.5 to 1.75 s."""
    file = script(tmp_path, "teleop.py", TELEOP)
    keys = [(0.195, b"i"), (1.195, b"k"), (1.495, b","), (1.745, b"k")]
    x, state, is_restored = drive_by_keys(file, keys, 2.0)
    assert x == pytest.approx(2 * 0.1 * (1.0 - 0.25), abs=0.01)
    assert is_restored
    assert drive_by_keys(file, keys, 2.0) == (x, state, True)
    assert lines(capsys) == ["restored"] * 2
    assert drive_by_keys(file, [*keys, (1.8, b"\x03")], 2.0)[2]


def test_the_processs_own_input_is_as_before(monkeypatch, pipe):
    before = sys.stdin, input
    with rovers(1).build() as twin:
        nodes = Nodes(twin, [])
        pipe.write(b"own\n")
        assert input() == "own"
        nodes.close()
    assert (sys.stdin, input) == before
