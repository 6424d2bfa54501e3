"""A node that takes too much is ended at a stated limit, and the others continue."""

import os
import signal
from contextlib import suppress

import pytest
from conftest import rovers
from node_runs import lines, script

from drake_twin import Twin
from drake_twin.findings import Kind
from drake_twin.nodes import child_processes
from drake_twin.nodes.memory import most_memory, resident
from drake_twin.nodes.nodes import Nodes

WITNESS = "import time\nwhile True:\n    time.sleep(0.1)\n    print('here')\n"
MEGABYTES = 1 << 20


def run(folder, text, until=0.25, **limits):
    """What a node that takes too much has said, with its program and the resident memory at the end."""
    file, witness = script(folder, "f.py", text), script(folder, "witness.py", WITNESS)
    with Twin(rovers(1).node(file).node(witness).scenario()) as twin:
        nodes = Nodes(twin, **limits)
        try:
            twin.advance_to(until)
            (finding,) = (item for item in twin.findings if item.kind is Kind.FAILED)
            return finding.what.replace(str(file), "FILE"), nodes.programs[0], resident()
        finally:
            nodes.close()


@pytest.mark.skipif(not resident(), reason="the system does not tell how much memory a process has")
@pytest.mark.parametrize(
    "text",
    [
        "data = []\nwhile True:\n    data.append(b'x' * 1_000_000)\n",
        "import time\ndata = []\nwhile True:\n    data.append(b'x' * 1_000_000)\n    time.sleep(0.001)\n",
    ],
    ids=["in one turn", "a little in each turn"],
)
def test_a_node_that_eats_memory_is_ended_and_gives_it_back(tmp_path, capsys, text):
    before = resident()
    what, program, after = run(tmp_path, text, memory=200 * MEGABYTES)
    assert what.startswith("node f.py: it has taken more than 0.195 GiB of memory, and is ended (FILE:")
    assert program.exit_code == -signal.SIGKILL
    assert after < before + 150 * MEGABYTES
    assert lines(capsys) == ["here", "here"]


@pytest.mark.skipif(not resident(), reason="the system does not tell how much memory a process has")
def test_a_node_may_take_what_the_limit_leaves(tmp_path):
    file = script(tmp_path, "f.py", "import time\ndata = b'x' * 50_000_000\ntime.sleep(0.1)\nprint(len(data))\n")
    with Twin(rovers(1).node(file).scenario()) as twin:
        nodes = Nodes(twin, memory=400 * MEGABYTES)
        twin.advance_to(0.2)
        nodes.close()
        assert twin.findings == ()


def test_the_limit_is_at_most_half_of_the_machine():
    assert 0 < most_memory() <= 4 << 30
    assert most_memory() <= os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2


@pytest.mark.parametrize(
    "start",
    [
        "subprocess.Popen(['sleep', '60'])",
        "os.posix_spawnp('sleep', ['sleep', '60'], os.environ)",
        "os.fork() or os.execvp('sleep', ['sleep', '60'])",
    ],
)
def test_a_node_that_starts_processes_without_end_is_ended_with_them(tmp_path, capsys, monkeypatch, start):
    monkeypatch.setattr(child_processes, "MOST_PROCESSES", 3)
    what, program, _ = run(tmp_path, f"import os, subprocess, time\nwhile True:\n    {start}\n    time.sleep(0.01)\n")
    assert what == "node f.py: it has started 3 processes that still run, and is ended with them (FILE:3)"
    numbers = program.children._running
    assert len(numbers) == 3
    for number in numbers:
        with suppress(ChildProcessError):  # its end is known already
            assert os.waitid(os.P_PID, number, os.WEXITED | os.WNOWAIT).si_status == signal.SIGKILL
    assert lines(capsys) == ["here", "here"]


def test_processes_that_have_ended_do_not_count(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(child_processes, "MOST_PROCESSES", 3)
    text = "import subprocess\nfor _ in range(8):\n    subprocess.run(['true'], check=True)\nprint('done')\n"
    with Twin(rovers(1).node(script(tmp_path, "f.py", text)).scenario()) as twin:
        nodes = Nodes(twin)
        for _ in range(200):
            twin.advance_to(twin.time + 0.01)
            if "done" in (out := lines(capsys)):
                break
        nodes.close()
        assert twin.findings == ()
    assert "done" in out


def test_forks_of_forks_are_counted(tmp_path, monkeypatch):
    """Each of them writes its mark where all see it; without a limit there would be 63."""
    monkeypatch.setattr(child_processes, "MOST_PROCESSES", 8)
    text = (
        "import os\nif not os.fork():\n    for _ in range(6):\n        os.fork()\n"
        f"    open(r'{tmp_path}/' + str(os.getpid()), 'w').close()\n    os._exit(0)\nos.wait()\n"
    )
    with Twin(rovers(1).node(script(tmp_path, "f.py", text)).scenario()) as twin:
        nodes = Nodes(twin)
        marks = None
        for _ in range(50):
            twin.advance_to(twin.time + 0.01)
            marks = nodes.programs[0].children._marks
        nodes.close()
        assert 1 <= 4096 - marks[:].count(0) < 63


def test_an_error_that_nothing_catches_ends_a_loop_that_catches_all(tmp_path, capsys):
    text = "while True:\n    try:\n        x = 1\n    except:\n        pass\n"
    what, _, _ = run(tmp_path, text, patience=0.2)
    assert what.startswith("node f.py: it has computed for ")
    assert lines(capsys) == ["here", "here"]
