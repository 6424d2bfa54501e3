"""Nodes that fail: each is said in one paragraph, and the twin and the other nodes continue."""

import os
import re
import sys

import pytest
from node_runs import HEAD, lines, running, script

from drake_twin.findings import Kind
from drake_twin.nodes.nodes import Nodes

FOLDER = ": give the folder of this ROS package by --package-path"
COMPILED = ": ROS's is compiled from C++, and the twin does not have it"
WITNESS = """
class My(Node):
    def __init__(self):
        super().__init__("witness")
        self.create_timer(0.1, lambda: print("here", self.get_clock().now().nanoseconds // 1000000))
"""


def failed(twin) -> str:
    """What the one node that has failed has said."""
    (finding,) = (item for item in twin.findings if item.kind is Kind.FAILED)
    return finding.what


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("x = 1\nraise ValueError('no\\nway')", "ValueError: no way ({file}:2)"),
        ("import sys\nsys.exit(3)", "it has ended with exit code 3 ({file}:2)"),
        ("import sys\nsys.exit('no plan')", "it has ended with exit code no plan ({file}:2)"),
        ("import nav3_commander", "ModuleNotFoundError: No module named 'nav3_commander' ({file}:1)"),
        ("import rclpy.nowhere", "ModuleNotFoundError: No module named 'rclpy.nowhere'{own} ({file}:1)"),
        ("x = (", "SyntaxError: '(' was never closed (f.py, line 1) ({file}:1)"),
        ("import rclpy\nrclpy.create_node('n')", "NotInitializedException: {not_initialized} ({file}:2)"),
    ],
)
def test_a_node_that_raises(tmp_path, capsys, text, why):
    file = script(tmp_path, "f.py", text)
    with running(file, script(tmp_path, "witness.py", WITNESS)) as twin:
        twin.advance_to(0.25)
        not_initialized = "rclpy.init() has not been called. msg:cannot create node"
        own = ": the twin's own rclpy does not have this module"
        expected = why.format(file=file, not_initialized=not_initialized, own=own)
        assert failed(twin).replace(f"({file.name}, line 1)", "(f.py, line 1)") == f"node f.py: {expected}"
    assert lines(capsys) == ["here 100", "here 200"]


@pytest.mark.parametrize(
    ("module", "missing", "remedy"),
    [
        ("serial", "serial", ": pip install pyserial"),
        ("arm_msgs.msg", "arm_msgs", FOLDER),
        ("gripper", "gripper", FOLDER),
        ("mine.srv", "mine.srv", ": the package has no .srv files"),
        ("elsewhere", "elsewhere", ""),
        ("px4_msgs.msg", "px4_msgs", f"{FOLDER}; it is in PX4/px4_msgs on GitHub"),
        ("ros2node.api", "ros2node", f"{FOLDER}; it is in ros2/ros2cli on GitHub"),
        ("tf2_kdl", "tf2_kdl", f"{COMPILED}: use tf2_geometry_msgs"),
        ("cv_bridge.boost", "cv_bridge.boost", ": the twin's own cv_bridge does not have this module"),
    ],
)
def test_what_lacks_a_module_is_told_where_it_may_come_from(tmp_path, monkeypatch, module, missing, remedy):
    """A package.xml names what is a ROS package, as do the endings of packages of messages."""
    monkeypatch.setitem(sys.modules, "serial", None)
    (tmp_path / "package.xml").write_text("<package><name>mine</name><exec_depend>gripper</exec_depend></package>")
    (tmp_path / "msg").mkdir()
    (tmp_path / "msg" / "Mine.msg").write_text("bool a\n")
    file = script(tmp_path, "f.py", f"import {module}")
    with running(file) as twin:
        twin.advance_to(0.1)
        text = failed(twin).replace("import of serial halted; None in sys.modules", "No module named 'serial'")
        assert text == f"node f.py: ModuleNotFoundError: No module named {missing!r}{remedy} ({file}:1)"


def test_an_error_in_a_callback_is_told_with_its_line(tmp_path):
    file = script(
        tmp_path,
        "f.py",
        """
class My(Node):
    def __init__(self):
        super().__init__("f")
        self.create_timer(0.1, self.tick)

    def tick(self):
        return 1 / 0
""",
    )
    with running(file) as twin:
        twin.advance_to(0.2)
        number = file.read_text().splitlines().index("        return 1 / 0") + 1
        assert failed(twin) == f"node f.py: ZeroDivisionError: division by zero ({file}:{number})"


def test_a_module_that_has_to_be_compiled_says_so(tmp_path):
    """As yasmin's from release 4 on."""
    package = tmp_path / "machine"
    script(package, "package.xml", "<package><name>machine</name></package>")
    script(
        package, "CMakeLists.txt", "ament_python_install_package(machine)\npybind11_add_module(state src/state.cpp)\n"
    )
    script(package, "machine/__init__.py", "from machine.state import State\n")
    file = script(package, "machine/run.py", f"import sys\nsys.path.insert(0, {str(package)!r})\nimport machine\n")
    with running(file) as twin:
        twin.advance_to(0.01)
        why = "it has to be compiled from C++, as the CMakeLists.txt of its package says"
        found = f"node run.py: ModuleNotFoundError: No module named 'machine.state': {why} ({file}:3)"
        assert failed(twin) == found


def test_an_exit_without_an_error_is_none(tmp_path):
    with running(script(tmp_path, "f.py", "import sys\nsys.exit(0)")) as twin:
        twin.advance_to(0.1)
        assert twin.findings == ()


def test_a_node_that_blocks_is_let_out(tmp_path, capsys, caplog):
    reading, writing = os.pipe()
    text = f"import os, time\nprint(os.read({reading}, 1))\nprint(time.time())\n"
    with running(script(tmp_path, "f.py", text), script(tmp_path, "witness.py", WITNESS)) as twin:
        twin.advance_to(0.25)
        assert [record.getMessage() for record in caplog.records] == [
            f"node f.py waits for something outside of the simulation, which continues ({tmp_path / 'f.py'}:2)"
        ]
        os.write(writing, b"x")
        out = ""
        for _ in range(1000):  # until it has come back
            twin.advance_to(twin.time + 0.01)
            out += capsys.readouterr().out
            if "b'x'" in out:
                break
        assert "here 100\nhere 200" in out
        twin.advance_to(twin.time + 0.02)
    os.close(reading)
    os.close(writing)


def test_a_node_that_blocks_again_is_let_out_sooner(tmp_path, capsys, caplog, monkeypatch):
    """And that is said once for each place."""
    reading, writing = os.pipe()
    text = f"import os, time\nwhile True:\n    print(os.read({reading}, 1) or exit())\n    time.sleep(0.01)\n"
    with running(script(tmp_path, "f.py", text)) as twin:
        for letter in "abc":
            twin.advance_to(twin.time + 0.05)
            monkeypatch.setattr("drake_twin.nodes.turns._BLOCKED", 10**9)
            os.write(writing, letter.encode())
            for _ in range(1000):
                twin.advance_to(twin.time + 0.01)
                if f"b'{letter}'" in capsys.readouterr().out:
                    break
        assert len(caplog.records) == 1
        os.close(writing)  # so that the node reads on, and ends
        twin.advance_to(twin.time + 0.1)
    os.close(reading)


def test_a_node_that_is_back_where_it_blocked_is_let_out_at_once(tmp_path, capsys, monkeypatch):
    """As in the main loop of a window, between two callbacks that publish."""
    reading, writing = os.pipe()
    text = f"import os, time\nwhile True:\n    print(os.read({reading}, 1) or exit())\n    time.sleep(0.01)\n"
    with running(script(tmp_path, "f.py", text)) as twin:
        for letter in "abc":
            twin.advance_to(twin.time + 0.05)
            for name in ("_BLOCKED", "_BLOCKED_AGAIN"):
                monkeypatch.setattr(f"drake_twin.nodes.turns.{name}", 10**9)
            os.write(writing, letter.encode())
            for _ in range(1000):
                twin.advance_to(twin.time + 0.01)
                if f"b'{letter}'" in capsys.readouterr().out:
                    break
        os.close(writing)  # so that the node reads on, and ends
        twin.advance_to(twin.time + 0.1)
    os.close(reading)


def test_standard_input_is_waited_for_outside(tmp_path, capsys, monkeypatch):
    reading, writing = os.pipe()
    with (
        open(reading) as stream,
        running(script(tmp_path, "f.py", "print('got', input())"), script(tmp_path, "witness.py", WITNESS)) as twin,
    ):
        monkeypatch.setattr(sys.stdin, "_real", stream)
        twin.advance_to(0.15)
        assert lines(capsys) == ["here 100"]
        os.write(writing, b"hello\n")
        os.close(writing)
        for _ in range(1000):
            twin.advance_to(twin.time + 0.01)
            if "got hello" in (out := lines(capsys)):
                break
        assert "got hello" in out


def test_select_polls_in_simulated_time(tmp_path, capsys):
    text = "import select, time\nfound = select.select([{}], [], [], 0.2)\nprint(found[0], round(time.time(), 3))\n"
    reading, writing = os.pipe()
    with running(script(tmp_path, "f.py", text.format(reading))) as twin:
        twin.advance_to(0.3)
    os.close(reading)
    os.close(writing)
    assert lines(capsys) == ["[] 0.2"]


COMPUTES = r"node f.py: it has computed for \d+ s without a spin or a sleep, and is ended"
ALONE = r"node f.py: it is in a loop without end, as it has no other thread that could end it, and is ended"


@pytest.mark.parametrize(
    ("loop", "says"),
    [
        ("while True:\n    x = 1", ALONE),
        ("while True:\n    try:\n        x = 1\n    except Exception:\n        pass", COMPUTES),
    ],
)
def test_a_node_that_loops_for_ever_is_ended(tmp_path, capsys, loop, says):
    file = script(tmp_path, "f.py", loop)
    witness = script(tmp_path, "witness.py", WITNESS)
    from conftest import rovers

    scenario = rovers(1).node(file).node(witness).scenario()
    from drake_twin.twin.twin import Twin

    with Twin(scenario) as twin:
        nodes = Nodes(twin, patience=0.2)
        try:
            twin.advance_to(0.25)
        finally:
            nodes.close()
        why = failed(twin)
        assert re.match(says, why)
        assert f"({file}:" in why
    assert lines(capsys) == ["here 100", "here 200"]


def test_the_end_interrupts_nodes_as_ctrl_c_does(tmp_path, capsys):
    stubborn = script(
        tmp_path,
        "stubborn.py",
        HEAD + "import time\ntry:\n    time.sleep(100)\nfinally:\n    time.sleep(1)\n    print('ended')\n",
    )
    polite = script(
        tmp_path,
        "polite.py",
        HEAD
        + """
rclpy.init()
node = rclpy.create_node("polite")
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    print("interrupted", node.get_clock().now().nanoseconds)
""",
    )
    with running(stubborn, polite) as twin:
        twin.advance_to(0.1)
    assert lines(capsys) == ["interrupted 100000000", "ended"]


def test_a_missing_script_is_an_error(tmp_path):
    from drake_twin.errors import InputError

    with pytest.raises(InputError, match="the node's script does not exist"), running(tmp_path / "none.py"):
        pass
