"""How a healthy robot differs from its twin: what is learned from a run without faults, and kept in a file.

The difference of each number is explained by the twin's motion as far as a line can (a bearing that runs harder than
the file says, a motor that is weaker), and the rest is noise. Means of what is left over blocks of 0.1 s have a
standard deviation of their own, for a model's errors last longer than a measurement's.
"""

from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError, described
from drake_twin.mirror.cumulative_sums import BLOCK, cumulative_sums
from drake_twin.mirror.differences import Differing
from drake_twin.mirror.follower import Innovation
from drake_twin.mirror.watched import INERTIAL, JOINTS
from drake_twin.twin.saved_file import read_saved, write_saved
from drake_twin.versions import PROFILE

_SOFT = 0.05  # rad/s or m/s within which dry friction turns
_LEAST = {"position": 1e-5, "velocity": 1e-4, "effort": 1e-4}
_RIDGE = 1e-3  # of the features' own size
_EXPLAINS = 0.9  # of the differences' root mean square that is left, at most, where motion explains them
MOST_DEVIATIONS = 6.0  # standard deviations that one measurement counts
_FEW = 40  # values at rest or in motion that something is learned from
_MOST_AGAIN = 0.9  # correlation of blocks
_RUNNING = 0.05  # part of each measurement in a running mean
_LARGE = 2.5  # standard deviations
_LONGEST_DELAY = 0.3  # s
_MARGIN = 0.004  # s
SHORTEST = 5.0  # s of a run that something is learned from


@dataclass(frozen=True)
class Learned:
    """What is known of a number's differences.

    Attributes:
        weights: What the twin's motion explains of a difference; see `features`.
        noise: The standard deviation of what is left of one measurement: at rest, and in motion.
        spread: The root mean square of all that is left of one, outliers included, likewise.
        block: The standard deviation of its mean over a block in that of a measurement, likewise; larger where blocks
            depend on each other.
        jitter: The standard deviation of a measurement's own noise, from third differences of what is left.
        repeats: How many measurements had the same value, one after the other.
        highest: The highest cumulative sum of the healthy run.
        unsteady: How often the noise was much larger, at the worst time; see `Unsteadiness`.
        largest: The largest difference of one measurement (standard deviations).
    """

    weights: tuple[float, ...]
    noise: tuple[float, float]
    spread: tuple[float, float]
    block: tuple[float, float]
    jitter: float
    repeats: int
    highest: float
    unsteady: float
    largest: float


@dataclass(frozen=True)
class Profile:
    """What was learned of a robot.

    Attributes:
        topics: Topic → name of a number → what is known.
        duration: The length of the run (s).
        command_delay: How late the robot does what it is told (s).
    """

    topics: Mapping[str, Mapping[str, Learned]]
    duration: float
    command_delay: float = 0.0

    def save(self, file: Path) -> None:
        """Write it as JSON, whole.

        Raises:
            RunError: If it cannot be written.
        """
        topics = {topic: {name: asdict(item) for name, item in own.items()} for topic, own in self.topics.items()}
        data = {"duration": self.duration, "command_delay": self.command_delay, "topics": topics}
        write_saved(file, PROFILE, data)

    @classmethod
    def read(cls, file: Path) -> "Profile":
        """Read one.

        Raises:
            InputError: If the file cannot be read, or is not a profile.
        """
        data = read_saved(file, PROFILE, lambda data: data)
        try:
            topics = {topic: {name: _read(item) for name, item in own.items()} for topic, own in data["topics"].items()}
            return cls(topics, float(data["duration"]), float(data["command_delay"]))
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise InputError(f"the {PROFILE.what} is damaged ({described(error)})", file=file) from None


def _read(item: Mapping[str, Any]) -> Learned:
    values: dict[str, Any] = {key: tuple(value) if isinstance(value, list) else value for key, value in item.items()}
    return Learned(**values)


def is_moving(innovation: Innovation, name: str) -> bool:
    """Return whether the twin moves where a number is measured; of what rests, friction holds an unknown part."""
    own = innovation.predicted
    if innovation.watched.kind == JOINTS:
        return abs(own[f"{name.rpartition('.')[0]}.velocity"]) > _SOFT
    return innovation.watched.kind == INERTIAL or abs(own["linear.x"]) + abs(own["angular.z"]) > _SOFT


def features(innovation: Innovation, name: str) -> tuple[float, float, float, float]:
    """Return what may explain a difference: one, a speed, its sign (soft), and a load, of the twin's own motion."""
    own = innovation.predicted
    if innovation.watched.kind == JOINTS:
        joint = name.rpartition(".")[0]
        speed = own[f"{joint}.velocity"]
        return 1.0, speed, float(np.tanh(speed / _SOFT)), own[f"{joint}.effort"]
    if innovation.watched.kind == INERTIAL:
        return 1.0, own[name], 0.0, 0.0
    return 1.0, own["linear.x"], own["angular.z"], 0.0


def command_delay(innovations: Sequence[Innovation]) -> float:
    """Return how much later the joints did what the twin's did (s), as their velocities tell; zero if they do not.

    A little less than the estimate, so that a robot is later than its twin, if at all: see `Differing`.
    """
    own = [item for item in innovations if item.watched.kind == JOINTS and not item.caught_up]
    names = sorted({name for item in own for name in item.measured if name.endswith(".velocity")})
    own = [item for item in own if all(name in item.measured for name in names)]
    if not names or len(own) < 50:
        return 0.0
    times = np.array([item.time for item in own])
    measured = np.array([[item.measured[name] for name in names] for item in own])
    predicted = np.array([[item.predicted[name] for name in names] for item in own])
    speed = np.sqrt(np.mean(predicted**2, axis=0))
    moving = speed > _SOFT
    if not np.any(moving):
        return 0.0
    measured, predicted = measured[:, moving] / speed[moving], predicted[:, moving] / speed[moving]

    def misfit(late: float) -> float:
        moved = np.column_stack([np.interp(times - late, times, column) for column in predicted.T])
        return float(np.mean((measured - moved) ** 2))

    lates = np.arange(0.0, _LONGEST_DELAY, 0.002)
    misfits = [misfit(late) for late in lates]
    best = int(np.argmin(misfits))
    return max(float(lates[best]) - _MARGIN, 0.0) if misfits[best] < 0.9 * misfits[0] else 0.0


def learn(innovations: Iterable[Innovation], command_delay: float = 0.0) -> Profile:
    """Learn from a healthy run.

    Raises:
        InputError: If it is too short.
    """
    rows: dict[str, dict[str, list[tuple[float, ...]]]] = {}
    begin, end = np.inf, -np.inf
    differing = Differing()
    for item in innovations:
        begin, end = min(begin, item.time), max(end, item.time)
        differences = differing.of(item).values
        if item.caught_up:
            continue
        own = rows.setdefault(item.watched.topic, {})
        for name, difference in differences.items():
            row = item.time, difference, item.measured[name], is_moving(item, name), *features(item, name)
            own.setdefault(name, []).append(row)
    if not end - begin >= SHORTEST:
        raise InputError(f"{max(end - begin, 0.0):.1f} s are too short to learn from: {SHORTEST:g} s at least")
    topics = {
        topic: _as_careful({name: _learned(name, np.array(own)) for name, own in numbers.items() if len(own) > 20})
        for topic, numbers in rows.items()
    }
    return Profile(topics, float(end - begin), command_delay)


def _as_careful(numbers: dict[str, Learned]) -> dict[str, Learned]:
    """Return what was learned, where efforts at rest have the largest noise of all: pauses are few, and all differ."""
    efforts = {name: item for name, item in numbers.items() if name.endswith(".effort")}
    noise, spread, block = (
        max((getattr(item, field)[0] for item in efforts.values()), default=0.0)
        for field in ("noise", "spread", "block")
    )
    careful = {
        name: replace(item, noise=(noise, item.noise[1]), spread=(spread, item.spread[1]), block=(block, item.block[1]))
        for name, item in efforts.items()
    }
    return numbers | careful


def _learned(name: str, rows: np.ndarray) -> Learned:
    times, differences, measured, moving, explaining = rows[:, 0], rows[:, 1], rows[:, 2], rows[:, 3] > 0, rows[:, 4:]
    scale = np.sqrt(np.mean(explaining**2, axis=0)) + 1e-12
    scaled = explaining / scale
    normal = scaled.T @ scaled + _RIDGE * len(rows) * np.eye(scaled.shape[1])
    weights = np.linalg.solve(normal, scaled.T @ differences) / scale
    left = differences - explaining @ weights
    if _usual(left) > _EXPLAINS * _usual(differences):  # what explains little does harm where it was not learned
        weights, left = np.zeros_like(weights), differences
    least = _LEAST.get(name.rpartition(".")[2], 1e-4)
    noise = tuple(max(_usual(own), least) for own in _regimes(left, moving))
    deviations = left / np.where(moving, noise[1], noise[0])
    spread = tuple(max(float(np.sqrt(np.mean(own**2))), least) for own in _regimes(left, moving))
    largest = float(np.max(np.abs(deviations)))
    deviations = np.clip(deviations, -MOST_DEVIATIONS, MOST_DEVIATIONS)
    means, are_moving = block_means(times, deviations, moving)
    block = tuple(_long_run(own) for own in _regimes(means, are_moving))
    blocks = means / np.where(are_moving, block[1], block[0])
    highest = max(map(max, cumulative_sums(blocks)), default=0.0)
    jitter = max(_usual(np.diff(left, 3)) / float(np.sqrt(20)), least)
    unsteady = Unsteadiness(jitter)
    most = max(unsteady.add(value) for value in left.tolist())
    repeats = longest_repetition(measured)
    return Learned(
        tuple(weights.tolist()), _two(noise), _two(spread), _two(block), jitter, repeats, float(highest), most, largest
    )


def _usual(values: np.ndarray) -> float:
    """Return the root mean square of values, where outliers count as six standard deviations."""
    spread = float(np.median(np.abs(values))) / 0.6745
    limit = MOST_DEVIATIONS * spread if spread > 0 else np.inf
    return float(np.sqrt(np.mean(np.clip(values, -limit, limit) ** 2)))


def _regimes(values: np.ndarray, moving: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the values at rest and in motion; all of them where there are few of one."""
    found = values[~moving], values[moving]
    return tuple(own if len(own) >= _FEW else values for own in found)  # type: ignore[return-value]


def _two(values: Sequence[float]) -> tuple[float, float]:
    at_rest, in_motion = values
    return at_rest, in_motion


def _long_run(means: np.ndarray) -> float:
    """Return the standard deviation of blocks, as far as it adds up over many of them."""
    if len(means) <= 10:
        return 1.0
    spread = float(np.std(means))
    again = float(np.corrcoef(means[1:], means[:-1])[0, 1]) if spread > 0 else 0.0
    again = min(max(again, 0.0), _MOST_AGAIN)
    return max(spread * float(np.sqrt((1 + again) / (1 - again))), 0.05)


class Unsteadiness:
    """How often, of late, a number's own noise was more than two and a half times that of a healthy run.

    Args:
        jitter: The standard deviation of the noise in that run.
    """

    def __init__(self, jitter: float):
        self._last: deque[float] = deque(maxlen=4)
        self._limit = _LARGE * jitter * 20**0.5
        self.value = 0.0

    def add(self, left: float) -> float:
        """Add a measurement, and return the part of the last ones."""
        self._last.append(left)
        if len(self._last) == 4:
            a, b, c, d = self._last
            self.value += _RUNNING * (float(abs(d - 3 * c + 3 * b - a) > self._limit) - self.value)
        return self.value


def block_means(times: np.ndarray, values: np.ndarray, moving: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the means of values over blocks of 0.1 s that have any, and whether each ends in motion."""
    numbers = (times / BLOCK).astype(int)
    starts = np.flatnonzero(np.concatenate([[True], np.diff(numbers) != 0]))
    ends = np.append(starts[1:], len(values))
    return np.add.reduceat(values, starts) / (ends - starts), moving[ends - 1]


def longest_repetition(values: np.ndarray) -> int:
    """Return how many values are the same, one after the other, at most."""
    changes = np.flatnonzero(np.diff(values) != 0.0)
    edges = np.concatenate([[-1], changes, [len(values) - 1]])
    return int(np.max(np.diff(edges))) if len(values) else 0
