"""Programs that simulate start with more freed memory kept at hand, if nobody has chosen otherwise."""

import json
import os
import subprocess
import sys

import pytest

ROVER = "package://rover_description/urdf/rover.urdf.xacro"
TUNABLES = "glibc.malloc.tcache_count=200:glibc.malloc.hugetlb=1"
LOOK = "import os\nprint(os.environ.get('GLIBC_TUNABLES'), os.getpid())\n"

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the tunables are those of Linux's C library")


def started(folder, *command, **environment):
    """The tunables that a run has, whether its process is the one that was started, and its summary."""
    (folder / "look.py").write_text(LOOK)
    line = [*command, ROVER, "--headless", "--duration", "0.01", "--plugin", "look.py", "--summary", "summary.json"]
    process = subprocess.Popen(
        [sys.executable, *line], cwd=folder, env={**os.environ, **environment}, stdout=subprocess.PIPE, text=True
    )
    tunables, number = process.communicate()[0].splitlines()[0].split()
    assert process.returncode == 0
    return tunables, int(number) == process.pid, json.loads((folder / "summary.json").read_text())


RUN = ("-P", "-m", "drake_twin.run")


@pytest.mark.parametrize("command", [RUN, ("-P", "-m", "drake_twin", "run")])
def test_a_run_starts_again_with_its_tunable_in_the_same_process(tmp_path, command):
    tunables, is_same, summary = started(tmp_path, *command)
    assert (tunables, is_same) == (TUNABLES, True)
    assert summary["allocator"] == TUNABLES


def test_the_state_is_that_without_it(tmp_path):
    states = [started(tmp_path, *RUN, **more)[2] for more in ({}, {"DRAKE_TWIN_ALLOCATOR": "system"})]
    assert [each["allocator"] for each in states] == [TUNABLES, "system"]
    assert states[0]["state_sha256"] == states[1]["state_sha256"]


def test_what_a_person_has_chosen_stays(tmp_path):
    tunables, _, summary = started(tmp_path, *RUN, GLIBC_TUNABLES="glibc.malloc.tcache_count=11")
    assert tunables == "glibc.malloc.tcache_count=11"
    assert summary["allocator"] == "glibc.malloc.tcache_count=11"
    tunables, _, _ = started(tmp_path, *RUN, GLIBC_TUNABLES="glibc.malloc.arena_max=2")
    assert tunables == f"glibc.malloc.arena_max=2:{TUNABLES}"
    tunables, _, summary = started(tmp_path, *RUN, GLIBC_TUNABLES="glibc.malloc.hugetlb=0")
    assert tunables == summary["allocator"] == "glibc.malloc.hugetlb=0:glibc.malloc.tcache_count=200"


@pytest.mark.parametrize(
    "command", [("-m", "drake_twin.check"), ("-m", "drake_twin", "check"), ("-m", "drake_twin", "topic", "run")]
)
def test_programs_that_do_not_simulate_start_once(command):
    from drake_twin.allocator import simulates

    assert not simulates(list(command))
