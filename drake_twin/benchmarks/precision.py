"""Cost at equal error: every engine at the largest step or accuracy that comes near enough to its own finest run."""

import sys
from collections.abc import Mapping, Sequence
from itertools import chain
from statistics import median
from time import process_time

import numpy as np

from drake_twin.benchmarks.engine import Setting, compared, drive, observed
from drake_twin.benchmarks.measure import whole
from drake_twin.benchmarks.piles import PILES
from drake_twin.benchmarks.report import Cell, Table
from drake_twin.benchmarks.size import Size
from drake_twin.benchmarks.workloads import LONGEST_GRID, LOOK_AT, SAME_ERROR, WORKLOADS, Workload
from drake_twin.program import say

EVENT = 0.01  # s; the period of the stops in the runs with events
_ROVERS = WORKLOADS["cruising rovers"]
_SOLVERS = ("twin", "twin, similar", "twin, sap")  # the discrete engine with each of Drake's contact solvers
# The settings that are tried, from coarse to fine.
_STEPS = (0.02, 0.01, 0.005, 0.002, 0.001, 0.0005, 0.0002)  # s
_ACCURACIES = (1e-2, 1e-3, 1e-4, 3e-5, 1e-5, 5e-6, 3e-6, 2e-6, 1e-6, 3e-7, 1e-7)
_STEPS_OF_MUJOCO = (5e-3, 2e-3, 1e-3, 7e-4, 5e-4, 4e-4, 3e-4, 2.5e-4, 2e-4, 1.5e-4, 1e-4, 5e-5, 2.5e-5)  # s
_STEPS_OF = {"MuJoCo": _STEPS_OF_MUJOCO, "DART": (5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5)}  # s

Run = tuple[Setting, float, float]  # its setting, its error (rad or m), its real-time factor


def precision(size: Size) -> list[Table]:
    """Measure error and real-time factor of all settings, and the fastest of each engine at equal error."""
    tables, rows = [], []
    for workload in WORKLOADS.values():
        for count in size.counts if workload is _ROVERS else size.counts[:2]:
            for event in (None, EVENT) if workload is _ROVERS else (None,):
                say(f"  {count} {workload.name}", sys.stderr)
                case = _Case(size, workload, count, event)
                runs = [case.run(setting) for setting in chain(*case.ladders(_SOLVERS))]
                details = tuple((str(setting), f"{error:.1e}", factor) for setting, error, factor in runs)
                title = f"Work and precision: {case}"
                tables.append(Table("precision", title, ("setting", "error (rad)", "real-time factor"), details))
                rows.append(case.summary([run for run in runs if run[1] <= SAME_ERROR]))
    return [_table("precision", rows), *tables]


def equal_error(size: Size) -> list[Table]:
    """Measure each engine at the first of its settings, from coarse to fine, that is near enough."""
    rows = []
    several = (*WORKLOADS.values(), PILES["towers of ten boxes"], PILES["boxes at rest"])
    for workload in several[:1] if size.scale < 0.5 else several:
        for count in size.counts[: 1 if workload is PILES["towers of ten boxes"] else 2]:
            say(f"  {count} {workload.name}", sys.stderr)
            case = _Case(size, workload, count, None)
            found = (
                next((run for run in map(case.run, ladder) if run[1] <= SAME_ERROR), None)
                for ladder in case.ladders(_SOLVERS[:1])
            )
            rows.append(case.summary([run for run in found if run is not None]))
    return [_table("equal error", rows)]


class _Case:
    """Robots or boxes whose errors are measured after `LOOK_AT` (s)."""

    def __init__(self, size: Size, workload: Workload, count: int, event: float | None):
        self._size, self._workload, self._count, self._event = size, workload, count, event
        self._truths: dict[str, list[np.ndarray]] = {}

    def __str__(self) -> str:
        stops = "" if self._event is None else f", stopped every {self._event * 1e3:g} ms"
        return f"{self._count} {self._workload.name}{stops}"

    def ladders(self, solvers: Sequence[str]) -> list[list[Setting]]:
        """Return the settings of each engine, and of each solver of the discrete one, from coarse to fine."""
        others = compared()[1:]
        if self._is_quick:
            return [[Setting("twin", 0.01)], [self._cenic(1e-2)], *([Setting(name, 0.002)] for name in others)]
        return [
            *([Setting(name, step) for step in _STEPS] for name in solvers),
            [self._cenic(accuracy) for accuracy in _ACCURACIES],
            *([Setting(name, step) for step in _STEPS_OF[name]] for name in others),
        ]

    def run(self, setting: Setting) -> Run:
        """Run a setting, and its engine's finest ones if they have not run."""
        if setting.engine not in self._truths:
            self._truths[setting.engine] = [self._run(finest)[0] for finest in self._finest(setting.engine)]
        state, factor = self._run(setting)
        return setting, min(float(np.abs(state - truth).max()) for truth in self._truths[setting.engine]), factor

    def summary(self, near_enough: Sequence[Run]) -> tuple[Cell, ...]:
        """Return a row of `_table` with the fastest of each engine, measured by turns."""
        chosen: dict[str, Setting] = {}
        for name in compared():
            own = [run for run in near_enough if run[0].engine.partition(",")[0] == name]
            if own:
                chosen[name] = max(own, key=lambda run: run[2])[0]
        costs = self._costs(chosen)
        cells: list[Cell] = [str(self)]
        for name in compared():
            cells += [_without(name, str(chosen[name])), costs[name]] if name in chosen else ["none", None]
        for name in compared()[1:]:
            cells.append(costs["twin"] / costs[name] if {"twin", name} <= chosen.keys() else None)
        return tuple(cells)

    @property
    def _is_quick(self) -> bool:
        return self._size.scale < 0.5

    def _cenic(self, accuracy: float) -> Setting:
        return Setting("twin, cenic", self._event or LONGEST_GRID, accuracy)

    def _finest(self, engine: str) -> list[Setting]:
        """Return the settings whose runs are the truth; the nearer one counts."""
        if engine == "twin, cenic":
            return [self._cenic(1e-4 if self._is_quick else 1e-8)]
        if self._is_quick:
            return [Setting(engine, 0.0005)]
        if engine == "MuJoCo":  # finer runs do not always come closer to each other
            return [Setting(engine, step) for step in (0.00002, 0.000005)]
        if engine == "DART":
            return [Setting(engine, 0.00002)]
        return [Setting(engine, 0.0001 if self._count > 8 or self._workload.pile else 0.00005)]

    def _run(self, setting: Setting) -> tuple[np.ndarray, float]:
        """Return what errors are measured in, at `LOOK_AT`, and the real-time factor until then."""
        engine = setting.make(self._workload, self._count, self._size.folder)
        begin = process_time()
        drive(engine, self._workload, self._count, 0.0, LOOK_AT, self._event)
        return observed(engine, self._workload), LOOK_AT / (process_time() - begin)

    def _costs(self, settings: Mapping[str, Setting]) -> dict[str, float]:
        """Return processor times (µs for each simulated ms), measured by turns."""
        # Cruising robots cost less once they do not slip any longer.
        span = whole((5.0 if self._workload is _ROVERS else LOOK_AT) * min(1.0, self._size.scale), 0.1)
        times: dict[str, list[float]] = {name: [] for name in settings}
        for _ in range(min(3, self._size.repeats)):
            for name, setting in settings.items():
                engine = setting.make(self._workload, self._count, self._size.folder)
                begin = process_time()
                drive(engine, self._workload, self._count, 0.0, span, self._event)
                times[name].append(process_time() - begin)
        return {name: median(values) / span * 1e3 for name, values in times.items()}


def _without(engine: str, setting: str) -> str:
    return setting.removeprefix(engine).lstrip(", ")


def _table(section: str, rows: Sequence[tuple[Cell, ...]]) -> Table:
    names = compared()
    columns = ("work", *chain(*((f"{name} at", "µs/ms") for name in names)), *(f"twin ÷ {name}" for name in names[1:]))
    error = f"{SAME_ERROR:g} rad or m from the engine's own finest run after {LOOK_AT:g} s"
    return Table(section, f"Processor time at equal error: {error}", columns, tuple(rows))
