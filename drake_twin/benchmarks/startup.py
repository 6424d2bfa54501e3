"""The start-up time of a twin by phases, and the memory of a robot; each is measured in a process of its own."""

import json
import resource
import subprocess
import sys
from functools import partial
from statistics import median

from drake_twin.benchmarks.measure import by_turns, ratio
from drake_twin.benchmarks.report import Table
from drake_twin.benchmarks.size import Size

_IMPORTS = "import pydrake.multibody.plant, pydrake.geometry, pydrake.systems.analysis"
_BARE = "pydrake's three modules"
_RUNS = ("--robots 2", "--robots 8", "diagrams/two_arms.yaml", "diagrams/rover_and_arm.launch.xml")
_PROCESSES = {"python -c pass": ["-c", "pass"], _BARE: ["-c", _IMPORTS]} | {
    f"drake_twin.run {words} --headless --duration 0.01": [
        *("-m", "drake_twin.run", *words.split(), "--headless", "--duration", "0.01")
    ]
    for words in _RUNS
}
_PHASES = """
import json
from time import perf_counter
times, begin = {}, perf_counter()
def phase(name):
    global begin
    now = perf_counter()
    times[name], begin = now - begin, now
import pydrake.multibody.plant, pydrake.geometry, pydrake.systems.analysis
phase("import pydrake's three modules")
import drake_twin.run, drake_twin.twin.twin
from drake_twin.builder.demo import demo_scenario
phase("import drake_twin")
scenario = demo_scenario("rover", 2)
phase("the scenario")
from drake_twin.description.package_index import PackageIndex
from drake_twin.planning.plan_robot import plan_robot
packages = PackageIndex(())
plans = [plan_robot(robot, packages) for robot in scenario.robots]
phase("xacro, URDF and parameters of two rovers")
twin = drake_twin.twin.twin.Twin(scenario)
phase("the same again, the diagram and its first state")
twin.step()
phase("commands and the first step")
print(json.dumps(times))
"""
_MEMORY = """
import sys
from pathlib import Path
from drake_twin.builder.demo import demo_scenario
from drake_twin.twin.twin import Twin
from drake_twin.benchmarks.size import Size
def resident():
    return next(int(line.split()[1]) for line in Path("/proc/self/status").read_text().splitlines() if "VmRSS" in line)
kept = Twin(demo_scenario("rover", 1))
kept.step()
before = resident()
twin = Twin(demo_scenario("rover", int(sys.argv[1])))
twin.step()
print((resident() - before) / int(sys.argv[1]) / 1024)
"""


def startup(size: Size) -> list[Table]:
    """Measure whole processes, the phases of one, and the memory of a rover."""
    for arguments in _PROCESSES.values():
        _run(arguments)  # which fills the caches
    cases = {name: partial(_run, arguments) for name, arguments in _PROCESSES.items()}
    wall, used = by_turns(cases, size.repeats), by_turns(cases, size.repeats, _processor_time)
    whole = tuple(
        (name, median(wall[name]), ratio(wall, name, _BARE), median(used[name]), ratio(used, name, _BARE))
        for name in cases
    )
    phases = [json.loads(_run(["-c", _PHASES])) for _ in range(size.repeats)]
    more = 4 if size.scale < 0.5 else 16
    memory = float(_run(["-c", _MEMORY, str(more)]))
    return [
        Table(
            "startup",
            "Whole processes, warm caches",
            ("process", "s", f"÷ {_BARE}", "processor time (s)", f"÷ {_BARE}, processor time"),
            whole,
        ),
        Table(
            "startup",
            "Phases of a start",
            ("phase", "ms"),
            tuple((name, 1e3 * median(item[name] for item in phases)) for name in phases[0]),
        ),
        Table("startup", f"Resident memory, mean of {more} rovers", ("per rover (MB)",), ((memory,),)),
    ]


def _processor_time() -> float:
    """Return the processor time of the processes that have been run (s)."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _run(arguments: list[str]) -> str:
    return subprocess.run([sys.executable, *arguments], check=True, capture_output=True, text=True).stdout
