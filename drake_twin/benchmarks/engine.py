"""The interface of the engines, and their settings."""

from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from math import floor
from pathlib import Path
from typing import Protocol

import numpy as np

from drake_twin.benchmarks.workloads import Workload
from drake_twin.dataclass import dataclass


class Engine(Protocol):
    """The robots of a workload in one engine, at time zero at first."""

    def command(self, velocities: np.ndarray) -> None:
        """Command joint velocities (rad/s), shape (robots, joints), from now on."""

    def advance_to(self, time: float) -> None:
        """Advance to a simulation time (s)."""

    def positions(self) -> np.ndarray:
        """Return the positions of the commanded joints (rad), shape (robots, joints)."""

    def centers(self) -> np.ndarray:
        """Return the positions of the loose boxes' centers (m), shape (boxes, 3)."""


@dataclass(frozen=True)
class Setting:
    """An engine with its step or accuracy.

    Attributes:
        engine: One of `ENGINES`.
        step: The step (s); with ``cenic`` the grid of times at which the twin stops it.
        accuracy: The accuracy of ``cenic``.
    """

    engine: str
    step: float = 0.001
    accuracy: float | None = None

    def __str__(self) -> str:
        value = f"{self.step * 1e3:g} ms" if self.accuracy is None else f"{self.accuracy:g}"
        return f"{self.engine} {value}"

    def make(self, workload: Workload, count: int, folder: Path) -> Engine:
        """Return the workload's robots in this engine.

        Args:
            workload: The workload.
            count: The number of robots.
            folder: A folder for files that the engine reads.
        """
        module, name = ENGINES[self.engine]
        engine: Engine = getattr(import_module(f"drake_twin.benchmarks.engines.{module}"), name)(
            workload, count, folder, self
        )
        return engine


ENGINES = {
    "twin": ("twin", "TwinEngine"),
    "twin, similar": ("twin", "TwinEngine"),
    "twin, sap": ("twin", "TwinEngine"),
    "twin, cenic": ("twin", "TwinEngine"),
    "bare plant": ("bare_plant", "BarePlant"),
    "bare plant, sampled ports": ("bare_plant", "SampledBarePlant"),
    "MuJoCo": ("mujoco", "MujocoEngine"),
    "DART": ("dart", "DartEngine"),
    "PyBullet": ("pybullet", "PybulletEngine"),
}
# The modules of engines that have no package for every Python and system: they are left out where they are absent.
OPTIONAL_MODULES = {"DART": "dartpy", "PyBullet": "pybullet"}


def is_present(engine: str) -> bool:
    """Tell whether the module of an engine of `ENGINES` is installed."""
    return engine not in OPTIONAL_MODULES or find_spec(OPTIONAL_MODULES[engine]) is not None


def compared() -> list[str]:
    """Return the engines that stand beside each other, the twin first."""
    return [name for name in ("twin", "DART", "MuJoCo") if is_present(name)]


def observed(engine: Engine, workload: Workload) -> np.ndarray:
    """Return what errors are measured in: positions of joints (rad), or those of a pile's boxes (m)."""
    return engine.positions() if workload.pile is None else engine.centers()


def drive(engine: Engine, workload: Workload, count: int, begin: float, end: float, event: float | None = None) -> None:
    """Run a workload.

    Args:
        engine: The engine, at the time ``begin``.
        workload: The workload.
        count: The number of robots.
        begin: The present time (s), a multiple of both periods.
        end: The time to stop at (s).
        event: The period of further stops, as for a reader of the state (s).
    """
    if begin == 0.0 or workload.period is not None:
        engine.command(workload.commands(count, begin))
    every = min((period for period in (workload.period, event) if period is not None), default=None)
    if every is not None:
        for index in range(1, floor((end - begin) / every + 1e-9) + 1):
            time = begin + index * every
            engine.advance_to(time)
            if workload.period is not None and time < end - 1e-9 and _is_multiple(time, workload.period):
                engine.command(workload.commands(count, time))
    engine.advance_to(end)


def turn(engine: Engine, workload: Workload, count: int, span: float, begin: float = 0.0) -> Callable[[], object]:
    """Return a function that runs an engine for a span (s) each time it is called, from a time (s) on."""
    turns = [0]

    def run() -> None:
        start = begin + turns[0] * span
        turns[0] += 1
        drive(engine, workload, count, start, start + span)

    return run


def _is_multiple(time: float, period: float) -> bool:
    return abs(time / period - round(time / period)) < 1e-6
