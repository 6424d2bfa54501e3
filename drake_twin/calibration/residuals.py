"""How far a twin is from a log: measured minus simulated at the measurements' stamps, over the noise.

What the log leaves open is found at each comparison, without another simulation: each topic's delay (the offset of its
clock plus the delays of commands and measurements, of which a log shows only the sum), and the frame that poses are in
(x, y, z and yaw).
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from drake_twin.calibration.log import Log, Measured, Series
from drake_twin.calibration.measured import kind_of
from drake_twin.calibration.noise import noises
from drake_twin.calibration.simulated import Simulated
from drake_twin.dataclass import dataclass

_GRID = 33  # delays that are tried before the best is refined
_EXACT = 1e-6  # s
_SMALL = 1e-3  # s


@dataclass(frozen=True)
class _Topic:
    """A topic of a log, as arrays: its numbers one after the other.

    Attributes:
        measured: The measurements.
        sigmas: The noise of each number.
        counts: Of how many measurements each number's start is the mean; zero where it is known.
    """

    measured: Measured
    sigmas: dict[str, float]
    counts: Mapping[str, int]

    @property
    def used(self) -> list[str]:
        """The numbers whose noise is above zero: the others never change in the log."""
        return [name for name in self.measured.series if self.sigmas[name] > 0]


@dataclass(frozen=True)
class Compared:
    """A comparison.

    Attributes:
        residuals: Measured minus simulated over the noise, shape (N,). The twin begins at joint positions that are
            measured, too, so that the residuals share the errors of these: see `independent`.
        delays: The delay of each topic of each log (s).
    """

    residuals: np.ndarray
    delays: np.ndarray


def independent(residuals: np.ndarray, shared: np.ndarray) -> np.ndarray:
    """Return residuals that are independent again, of variance 1, without the errors that they share.

    Args:
        residuals: Shape (N,).
        shared: What each shared error of variance 1 changes in them, shape (N, K).
    """
    if not shared.shape[1]:
        return residuals
    modes, sizes, _ = np.linalg.svd(shared, full_matrices=False)
    return np.asarray(residuals - modes @ ((1.0 - (1.0 + sizes**2) ** -0.5) * (modes.T @ residuals)))


class Comparison:
    """Compares what twins would have measured with what was measured.

    Args:
        logs: The logs.
        given: Kind or name of a number → its standard deviation, where it is not estimated.
        starts: For each log: name of a joint's position → of how many measurements its start is the mean.
        longest_delay: The largest delay to look for (s), to both sides; zero for none.

    Attributes:
        is_late: Which residuals are of the second half of their log, shape (N,).
        labels: The topic and name of each residual's number, by the index in `label_of`.
        label_of: Shape (N,).
        log_of: The index of the log of each residual, shape (N,).
        freedoms: How many numbers are found at each comparison.
    """

    def __init__(
        self,
        logs: Sequence[Log],
        given: Mapping[str, float],
        starts: Sequence[Mapping[str, int]],
        longest_delay: float,
    ):
        self._longest, self._given = longest_delay, given
        self._logs = [
            [_Topic(item, noises(item, given), counts) for item in log.measured]
            for log, counts in zip(logs, starts, strict=True)
        ]
        self.labels: list[tuple[str, str]] = []
        places: list[np.ndarray] = []
        late: list[np.ndarray] = []
        self.freedoms = 0
        counts = []
        for log, topics in zip(logs, self._logs, strict=True):
            counts.append(sum(len(topic.measured.series[name][0]) for topic in topics for name in topic.used))
            for topic in topics:
                self.freedoms += (longest_delay > 0) + len({"x", "y", "z", "yaw"} & set(topic.used))
                for name in topic.used:
                    times, _ = topic.measured.series[name]
                    places.append(np.full(len(times), len(self.labels)))
                    late.append(times > log.end / 2)
                    self.labels.append((topic.measured.topic, name))
        self.label_of = np.concatenate(places) if places else np.zeros(0, dtype=int)
        self.log_of = np.repeat(np.arange(len(logs)), counts)
        self.is_late = np.concatenate(late) if late else np.zeros(0, dtype=bool)

    @property
    def topics(self) -> list[str]:
        """The topic of each delay."""
        return [topic.measured.topic for topics in self._logs for topic in topics]

    def of_starts(self) -> np.ndarray:
        """Return what the errors of the joint positions at the start change, if they last unchanged; shape (N, K)."""
        columns = []
        label = 0
        for topics in self._logs:
            for topic in topics:
                for name in topic.used:
                    if count := topic.counts.get(name):
                        columns.append(np.where(self.label_of == label, count**-0.5, 0.0))
                    label += 1
        return np.array(columns).T if columns else np.zeros((len(self.label_of), 0))

    def start_errors(self) -> list[dict[str, float]]:
        """Return for each log: joint → standard error of its position at the start (rad or m)."""
        return [
            {
                name.rpartition(".")[0]: topic.sigmas[name] * topic.counts[name] ** -0.5
                for topic in topics
                for name in topic.used
                if topic.counts.get(name)
            }
            for topics in self._logs
        ]

    def settle_noise(self, simulated: Sequence[Simulated], delays: np.ndarray) -> np.ndarray:
        """Estimate the noise again, where it is less without the jumps that twins show, too.

        Args:
            simulated: What the twins of all logs have measured.
            delays: The delay of each topic.

        Returns:
            What residuals so far are to be multiplied with, shape (N,).
        """
        factors = []
        for (topic, series), delay in zip(self._pairs(simulated), delays, strict=True):
            again = noises(topic.measured, self._given, _values(topic, series, delay))
            for name in topic.used:
                factors.append(max(1.0, topic.sigmas[name] / again[name]))
                topic.sigmas[name] /= factors[-1]
        return np.asarray(np.array(factors)[self.label_of])

    @property
    def is_noise_given(self) -> bool:
        """Whether nothing is estimated."""
        every = [name for topics in self._logs for topic in topics for name in topic.used]
        return all(name in self._given or kind_of(name) in self._given for name in every)

    def sigma(self, index: int) -> float:
        """Return the noise of a label's number."""
        every = [topic.sigmas[name] for topics in self._logs for topic in topics for name in topic.used]
        return every[index]

    def compare(self, simulated: Sequence[Simulated]) -> Compared:
        """Compare what a twin would have measured in each log.

        Returns:
            The residuals at the best delays and frames.
        """
        residuals, delays = [], []
        for topic, series in self._pairs(simulated):
            delays.append(self._delay(topic, series))
            residuals.append(_residuals(topic, series, delays[-1]))
        return Compared(np.concatenate(residuals), np.array(delays))

    def delay_errors(self, simulated: Sequence[Simulated], delays: np.ndarray) -> np.ndarray:
        """Return the standard error that each delay has where the values are known (s)."""
        if not self._longest:
            return np.zeros(len(delays))
        found = []
        for (topic, series), delay in zip(self._pairs(simulated), delays, strict=True):
            slope = _residuals(topic, series, delay + _SMALL) - _residuals(topic, series, delay - _SMALL)
            found.append(2 * _SMALL / max(float(np.linalg.norm(slope)), 1e-9))
        return np.array(found)

    def curves(self, simulated: Sequence[Simulated], delays: np.ndarray) -> list[tuple[str, str, Series, Series]]:
        """Return topic, name, measured and simulated of each number, at given delays and in the log's frames."""
        found = []
        for (topic, series), delay in zip(self._pairs(simulated), delays, strict=True):
            fitted = _values(topic, series, delay)
            for name in topic.used:
                times, values = topic.measured.series[name]
                found.append((topic.measured.topic, name, (times, values), (times, fitted[name])))
        return found

    def _pairs(self, simulated: Sequence[Simulated]) -> Iterator[tuple[_Topic, Mapping[str, Series]]]:
        """Yield each topic of the logs, and what the log's twin would have measured of it."""
        for topics, own in zip(self._logs, simulated, strict=True):
            for topic in topics:
                yield topic, own[topic.measured.twin_topic]

    def _delay(self, topic: _Topic, simulated: Mapping[str, Series]) -> float:
        if not self._longest:
            return 0.0
        from scipy.optimize import minimize_scalar

        cost = partial(_cost, topic, simulated)
        grid = np.linspace(-self._longest, self._longest, _GRID)
        costs = [cost(delay) for delay in grid]
        best = int(np.argmin(costs))
        near = grid[max(best - 1, 0)], grid[min(best + 1, _GRID - 1)]
        found = minimize_scalar(cost, bounds=near, method="bounded", options={"xatol": _EXACT})
        return float(found.x) if found.fun <= costs[best] else float(grid[best])


def _cost(topic: _Topic, simulated: Mapping[str, Series], delay: float) -> float:
    residuals = _residuals(topic, simulated, delay)
    return float(residuals @ residuals)


def _residuals(topic: _Topic, simulated: Mapping[str, Series], delay: float) -> np.ndarray:
    values = _values(topic, simulated, delay)
    own = [(topic.measured.series[name][1] - values[name]) / topic.sigmas[name] for name in topic.used]
    return np.concatenate([np.zeros(0), *own])


def _values(topic: _Topic, simulated: Mapping[str, Series], delay: float) -> dict[str, np.ndarray]:
    """Return the simulated numbers at the measurements' stamps, in the frame of the measurements."""
    found = {}
    for name in topic.used:
        times, values = simulated[name]
        found[name] = np.interp(topic.measured.series[name][0] - delay, times, values)
    measured = {name: topic.measured.series[name][1] for name in found}
    if {"x", "y", "yaw"} <= found.keys():
        turn = float(np.mean(measured["yaw"] - found["yaw"])) if topic.sigmas["yaw"] else 0.0
        turn += _turn_left(topic, measured, found, turn)
        found["yaw"] = found["yaw"] + turn
        cosine, sine = np.cos(turn), np.sin(turn)
        x, y = found["x"], found["y"]
        found["x"], found["y"] = cosine * x - sine * y, sine * x + cosine * y
    for name in {"x", "y", "z"} & found.keys():
        found[name] = found[name] + float(np.mean(measured[name] - found[name]))
    return found


def _turn_left(
    topic: _Topic, measured: Mapping[str, np.ndarray], found: Mapping[str, np.ndarray], turn: float
) -> float:
    """Return by how much more to turn (rad), so that headings and places agree best, weighted by their noise."""
    x, y = found["x"] - found["x"].mean(), found["y"] - found["y"].mean()
    to_x, to_y = measured["x"] - measured["x"].mean(), measured["y"] - measured["y"].mean()
    cosine, sine = np.cos(turn), np.sin(turn)
    x, y = cosine * x - sine * y, sine * x + cosine * y
    weight_place, weight_yaw = topic.sigmas["x"] ** -2, topic.sigmas["yaw"] ** -2
    lever = weight_place * float(x @ to_x + y @ to_y)
    pull = weight_place * float(x @ to_y - y @ to_x)
    return float(np.arctan2(pull, lever + weight_yaw * len(x))) if lever + weight_yaw * len(x) > 0 else 0.0
