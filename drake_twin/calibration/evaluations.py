"""Every simulation of a search, kept: what the twin's distance from the logs is at each point."""

import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from drake_twin.calibration.fitted import Fitted
from drake_twin.calibration.residuals import Comparison, independent
from drake_twin.calibration.simulated import Simulated, SimulatedLog
from drake_twin.dataclass import dataclass
from drake_twin.errors import RunError
from drake_twin.program import say

_FAILED = 1e3  # times the noise: the residuals where the simulation fails
_PERIOD = 10.0  # s between two lines of progress

Point = np.ndarray


class Stopped(Exception):  # noqa: N818  # nothing is wrong
    """Raised when a search is stopped, or has used up its episodes."""


@dataclass(frozen=True)
class Evaluation:
    """A simulation of all logs.

    Attributes:
        point: The shares of the ranges, shape (p,).
        raw: The residuals, shape (N,).
        residuals: The same, independent of each other.
        delays: The delay of each topic (s).
    """

    point: Point
    raw: np.ndarray
    residuals: np.ndarray
    delays: np.ndarray

    @property
    def cost(self) -> float:
        """χ²: the sum of the squares of the residuals."""
        return float(self.residuals @ self.residuals)


class Evaluations:
    """Simulates logs at points, each once.

    Args:
        fitted: What is searched.
        logs: The twins that repeat the logs.
        comparison: Compares them.
        most: How often a log may be simulated.
        stopped: Ends the search when there is something in it.
        tell: Whether to print the progress.

    Attributes:
        every: All evaluations, in order.
        episodes: How often a log was simulated.
        most: How often it may be.
    """

    def __init__(
        self,
        fitted: Sequence[Fitted],
        logs: Sequence[SimulatedLog],
        comparison: Comparison,
        most: int,
        stopped: Sequence[object] = (),
        *,
        tell: bool = False,
    ):
        self.fitted, self.comparison = tuple(fitted), comparison
        self.every: list[Evaluation] = []
        self.episodes = 0
        self.most = most
        self._logs, self._stopped, self._tell = tuple(logs), stopped, tell
        self._known: dict[bytes, Evaluation] = {}
        self._shared = comparison.of_starts()
        self._last_line = time.monotonic()

    @property
    def best(self) -> Evaluation:
        """The evaluation of the least χ²."""
        return min(self.every, key=lambda item: item.cost)

    @property
    def freedom(self) -> int:
        """Degrees of freedom: measurements minus all that is found from them."""
        return max(1, len(self.comparison.label_of) - len(self.fitted) - self.comparison.freedoms)

    @property
    def simulations(self) -> int:
        """How many logs there are, each of which is simulated at a point."""
        return len(self._logs)

    @property
    def left(self) -> int:
        """How many points may still be simulated."""
        return (self.most - self.episodes) // len(self._logs)

    def _check_left(self) -> None:
        if self._stopped or self.left < 1:
            raise Stopped

    def values(self, point: Point) -> dict[str, float]:
        """Return the values at a point."""
        return {item.path: item.at(float(share)) for item, share in zip(self.fitted, point, strict=True)}

    def at(self, point: Point) -> Evaluation:
        """Return the evaluation at a point.

        Raises:
            Stopped: If the search has to end.
        """
        point = np.clip(np.asarray(point, dtype=float), 0.0, 1.0)
        if point.tobytes() in self._known:
            return self._known[point.tobytes()]
        self._check_left()
        try:
            compared = self.comparison.compare(self.simulate(point))
            raw, delays = compared.residuals, compared.delays
        except RunError:
            raw, delays = np.full(len(self.comparison.label_of), _FAILED), np.zeros(len(self.comparison.topics))
        if not np.isfinite(raw).all():
            raw = np.full(len(raw), _FAILED)
        found = Evaluation(point, raw, independent(raw, self._shared), delays)
        self.every.append(found)
        self._known[point.tobytes()] = found
        self._say()
        return found

    def simulate(
        self, point: Point, moved: Mapping[int, Mapping[str, float]] = MappingProxyType({})
    ) -> list[Simulated]:
        """Return what the twins measure at a point.

        Args:
            point: The point.
            moved: Index of a log → joint → by how much it begins elsewhere (rad or m).

        Raises:
            RunError: If the simulation fails.
        """
        values, nothing = self.values(point), dict[str, float]()
        self.episodes += len(self._logs)
        return [log.run(values, moved.get(index, nothing)) for index, log in enumerate(self._logs)]

    def settle_starts(self, point: Point) -> None:
        """Simulate what errors of the joint positions at the start change, in place of taking them to last unchanged.

        All evaluations are another object afterwards.

        Raises:
            Stopped: If the search has to end.
            RunError: If a simulation fails.
        """
        before = self.at(point).raw
        columns = []
        every = [[*errors.items()] for errors in self.comparison.start_errors()]
        for turn in range(max(map(len, every))):
            self._check_left()
            moved = {index: dict(own[turn : turn + 1]) for index, own in enumerate(every)}
            change = self.comparison.compare(self.simulate(point, moved)).residuals - before
            columns += [np.where(self.comparison.log_of == index, change, 0.0) for index in range(len(every))]
        if columns:
            self._shared = np.array(columns).T
            self._change(np.ones(len(before)))

    def settle_noise(self, point: Point) -> None:
        """Estimate the noise again, without the jumps that the twins show, too; see `Comparison.settle_noise`.

        All evaluations are another object afterwards.

        Raises:
            Stopped: If the search has to end.
            RunError: If a simulation fails.
        """
        if self.comparison.is_noise_given:
            return
        self._check_left()
        here, simulated = self.at(point), self.simulate(point)
        self._change(self.comparison.settle_noise(simulated, here.delays))
        again = self.comparison.compare(simulated)  # as the delays depend on the noise
        place = next(index for index, item in enumerate(self.every) if item.point is here.point)
        residuals = independent(again.residuals, self._shared)
        self.every[place] = Evaluation(here.point, again.residuals, residuals, again.delays)
        self._known[here.point.tobytes()] = self.every[place]

    def _change(self, factors: np.ndarray) -> None:
        for index, item in enumerate(self.every):
            raw = factors * item.raw
            self.every[index] = replace(item, raw=raw, residuals=independent(raw, self._shared))
        self._known = {item.point.tobytes(): item for item in self.every}

    def jacobian(self, point: Point, steps: Sequence[float]) -> np.ndarray:
        """Return the derivatives of the residuals by the shares, over steps into the wider side; shape (N, p)."""
        here = self.at(point)
        found = np.zeros((len(here.residuals), len(point)))
        for index, step in enumerate(steps):
            there = np.array(point, dtype=float)
            there[index] += step if point[index] < 0.5 else -step
            other = self.at(there)
            found[:, index] = (other.residuals - here.residuals) / (other.point[index] - here.point[index])
        return found

    def _say(self) -> None:
        now = time.monotonic()
        if self._tell and now - self._last_line > _PERIOD:
            self._last_line = now
            say(f"{self.episodes} episodes, χ²/dof {self.best.cost / self.freedom:.4g}", sys.stderr)
