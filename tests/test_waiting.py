"""Tests do not sleep and read no clock: they would fail on a busy machine, and be slow on an idle one.

Programs that tests write as texts are not looked at: nodes sleep in simulated time, peers in processes of their own.
"""

import ast
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
CLOCKS = {"sleep", "perf_counter", "monotonic", "time", "time_ns", "process_time", "wait_for_timeout"}
ALLOWED = {
    "waiting.py": "the place where they wait",
    "mutants.py": "a program: it says how long the tests of each mutant took",
    "nodes/test_time.py": "that threads beside the nodes' have the real clock is what it tests",
    "wires/outside_node.py": "a node beside the twin, which gives up after a while",
    "wires/rclpy_contract.py": "a program beside the twin, which runs on the real rclpy, too",
    "wires/rclpy_double/rclpy/impl/implementation_singleton.py": "it waits as rcl does, in a process of its own",
    "wires/rclpy_peer.py": "a program beside the twin, on the real rclpy",
}
RECORDED = "p06_timers p09_services p11_executors p16_actions p18_events p22_graph p25_async p28_introspection"
ALLOWED |= {
    f"nodes/rclpy_outcomes/{name}.py": "a node's program, recorded beside the real rclpy: it sleeps in simulated time"
    for name in RECORDED.split()
}


def readings(file: Path) -> list[int]:
    """The lines of a file that sleep or read a clock: calls of the module time's functions, and of a page's wait."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    bare = {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.module == "time"
        for alias in node.names
    }
    found = []
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        called = node.func
        if isinstance(called, ast.Name) and called.id in bare & CLOCKS:
            found.append(node.lineno)
        if isinstance(called, ast.Attribute) and called.attr in CLOCKS:
            owner = called.value.id if isinstance(called.value, ast.Name) else ""
            yields = owner == "asyncio" and ast.unparse(node.args[0]) == "0"
            if (owner in ("time", "asyncio") and not yields) or called.attr == "wait_for_timeout":
                found.append(node.lineno)
    return found


def test_no_test_sleeps_or_reads_a_clock():
    places = {str(file.relative_to(TESTS)): readings(file) for file in TESTS.rglob("*.py")}
    assert {name: lines for name, lines in places.items() if lines and name not in ALLOWED} == {}
    assert {name for name in ALLOWED if not places[name]} == set(), "they need no permission"


@pytest.mark.parametrize(
    "text",
    ["import time\ntime.sleep(1)", "from time import sleep\nsleep(1)", "page.wait_for_timeout(1)", "time.monotonic()"],
)
def test_a_sleep_is_seen(tmp_path, text):
    file = tmp_path / "test_it.py"
    file.write_text(text)
    assert readings(file) == [len(text.splitlines())]


def test_what_gives_way_to_others_is_no_sleep(tmp_path):
    file = tmp_path / "test_it.py"
    file.write_text("await asyncio.sleep(0)\ntwin.time\nrate.sleep()")
    assert readings(file) == []
