"""A small sweep: a hinge with a motor, quick to build and to run."""

import os
import subprocess
import sys
from pathlib import Path

from hinge import write_hinge

from drake_twin.scenario import Command, Robot, Scenario
from drake_twin.scenario.scenario_file import scenario_to_yaml

METRICS = '''"""Metrics that fail for some start positions of the hinge."""
import ctypes
import os
import time


def start(history, messages):
    return history.robots["hinge"].positions[0][0]


def sick(history, messages):
    which = round(start(history, messages))
    if which == 1:
        raise ValueError("one is sick")
    if which == 2:
        time.sleep(1000)
    if which == 3:
        ctypes.string_at(0)
    if which in (4, 6):
        os._exit(7 if which == 4 else 0)
    return which


def heard(history, messages):
    (received,) = messages.values()
    return len(received)


heard.topics = ["/hinge/joint_states"]


def text(history, messages):
    return "fast"


def early(twin):
    return twin.time > 0.25
'''


def hinge_scenario(folder: Path) -> Scenario:
    """The scenario of a hinge that is commanded to turn."""
    robot = Robot("hinge", str(write_hinge(folder)))
    command = Command("/hinge/velocity/commands", (1.0,))
    return Scenario((robot,), time_step=0.001, commands=(command,))


def write_sweep(folder: Path) -> Path:
    """Writes ``hinge.yaml`` and ``metrics.py``; returns the folder."""
    (folder / "hinge.yaml").write_text(scenario_to_yaml(hinge_scenario(folder)))
    (folder / "metrics.py").write_text(METRICS)
    return folder


def program(folder: Path, *arguments: str, module: str = "sweep", **options) -> subprocess.Popen:
    """Starts ``drake_twin.sweep`` in a folder."""
    root = str(Path(__file__).resolve().parents[2])
    return subprocess.Popen(
        [sys.executable, "-m", f"drake_twin.{module}", *arguments],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": root},
        **options,
    )


def finished(
    folder: Path, *arguments: str, module: str = "sweep", timeout: float = 200, **options
) -> subprocess.CompletedProcess:
    """Runs ``drake_twin.sweep`` in a folder to its end."""
    started = program(folder, *arguments, **options)
    out, err = started.communicate(timeout=timeout)
    return subprocess.CompletedProcess(arguments, started.returncode, out, err)


def children(process: subprocess.Popen) -> list[int]:
    """The processes that a process has started."""
    return [int(item) for item in Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()]


def runs(process: int) -> bool:
    """Whether a process runs: it exists, and has not only not been waited for."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
