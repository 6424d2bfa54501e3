"""The twin beside other engines: processor time at 1 ms, and memory."""

import subprocess
import sys
from contextlib import ExitStack
from functools import partial
from statistics import median

from drake_twin.benchmarks.engine import compared
from drake_twin.benchmarks.measure import ratio
from drake_twin.benchmarks.piles import PILES
from drake_twin.benchmarks.report import Cell, Table
from drake_twin.benchmarks.size import Size
from drake_twin.benchmarks.worker import WORK, Worker
from drake_twin.benchmarks.workloads import HOLDING_ARMS, WORKLOADS, Workload
from drake_twin.program import say

_COUNTS = (1, 8, 32, 100)
_SPAN = 0.2  # s; simulated in a turn
_LONGEST_TURN = 8.0  # s of processor time; larger numbers are left out
_MEMORY = """
import ctypes, gc, sys, tempfile
from pathlib import Path
from drake_twin.benchmarks.engine import Setting, drive
from drake_twin.benchmarks.robots import prepare
from drake_twin.benchmarks.worker import WORK

def resident():
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)
    return next(int(line.split()[1]) for line in Path("/proc/self/status").read_text().splitlines() if "VmRSS" in line)

def make(count):
    engine = Setting(sys.argv[1]).make(WORK[sys.argv[2]], count, Path(folder))
    drive(engine, WORK[sys.argv[2]], count, 0.0, 0.01)
    return engine

with tempfile.TemporaryDirectory() as folder:
    first = make(1)
    prepare(WORK[sys.argv[2]], int(sys.argv[3]), Path(folder), 0.001)
    before = resident()
    second = make(int(sys.argv[3]))
    print((resident() - before) / int(sys.argv[3]) / 1024)
"""


def engines(size: Size) -> list[Table]:
    """Measure the twin beside DART, which is Gazebo's engine, and MuJoCo."""
    counts = _COUNTS if size.counts == Size.counts else size.counts
    return [_at_one_ms(size, counts), _memory(size)]


def _at_one_ms(size: Size, counts: tuple[int, ...]) -> Table:
    rows = []
    for workload in (HOLDING_ARMS, PILES["boxes at rest"]) if size.scale < 0.5 else WORK.values():
        longest = 0.0
        for index, count in enumerate(counts):
            if index and longest * count / counts[index - 1] > _LONGEST_TURN:
                break
            say(f"  {count} {workload.name}", sys.stderr)
            row, longest = _row(size, workload, count)
            rows.append(row)
    names = compared()
    columns = ("work", *names, *(f"twin ÷ {name}" for name in names[1:]))
    return Table(
        "engines",
        "Beside other engines: µs of processor time for each simulated ms, steps of 1 ms",
        columns,
        tuple(rows),
    )


def _row(size: Size, workload: Workload, count: int) -> tuple[tuple[Cell, ...], float]:
    """Return a row, and the longest of the engines' turns (s of processor time)."""
    is_quick = size.scale < 0.5
    span = 0.1 if is_quick else _SPAN
    times: dict[str, list[float]] = {name: [] for name in compared()}
    with ExitStack() as stack:
        workers = {name: stack.enter_context(Worker(name, workload, count)) for name in times}
        for worker in workers.values():
            worker.run(0.1 if is_quick else workload.timed_from)
        for _ in range(size.repeats):
            for name, worker in workers.items():
                times[name].append(worker.run(span))
    costs = [median(values) / span * 1e3 for values in times.values()]
    ratios = [ratio(times, "twin", name) for name in compared()[1:]]
    return (f"{count} {workload.name}", *costs, *ratios), max(costs) * span / 1e3


def _memory(size: Size) -> Table:
    more = 2 if size.scale < 0.5 else 16
    rows: list[tuple[Cell, ...]] = []
    several = (WORKLOADS["cruising rovers"], HOLDING_ARMS, PILES["boxes at rest"])
    for workload in several[:1] if size.scale < 0.5 else several:
        say(f"  memory: {workload.name}", sys.stderr)
        rows.append((workload.name, *map(partial(_megabytes, workload, more), compared())))
    title = f"Resident memory of one more (MB), mean of {more}, each engine in a process of its own"
    return Table("engines", title, ("of", *compared()), tuple(rows))


def _megabytes(workload: Workload, more: int, engine: str) -> float:
    command = [sys.executable, "-c", _MEMORY, engine, workload.name, str(more)]
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    return float(run.stdout.split()[-1])
