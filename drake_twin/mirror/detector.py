"""Tells when a robot differs from its twin more than it did while it was healthy."""

from collections.abc import Iterable, Mapping

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.mirror.cumulative_sums import BLOCK, CumulativeSums, threshold
from drake_twin.mirror.differences import Differing
from drake_twin.mirror.follower import Innovation
from drake_twin.mirror.profile import MOST_DEVIATIONS, Learned, Profile, Unsteadiness, features, is_moving

_ABOVE_HEALTHY = 3.0  # times the highest sum of the healthy run
_ABOVE_ON_GROUND = 5.0  # likewise of a robot on the ground, as contacts have rare events of their own
_SHORT = 30.0  # s of a healthy run that show half of what there is
_UNSTEADY = 0.45  # of the last measurements whose noise is large that are a change
_MORE_UNSTEADY = 1.5  # times that of the healthy run
_JUMP = 20.0  # standard deviations of one measurement of a position that are a jump
_SURPRISE = 8.0  # standard deviations of a velocity after which a position may be elsewhere, too
_CALM = 0.2  # s
_REPEATS = 8  # equal values, one after the other, of a number that changes else


@dataclass(frozen=True)
class Reading:
    """A number of a measurement, judged.

    Attributes:
        left: What the learned part of the model does not explain of the difference to the twin.
        deviations: The same in standard deviations of the healthy run.
    """

    left: float
    deviations: float


@dataclass(frozen=True)
class Judged:
    """A measurement, beside what the twin had, and how unusual the difference is.

    Attributes:
        innovation: The two.
        readings: Name of a number → what is left of its difference.
    """

    innovation: Innovation
    readings: Mapping[str, Reading]

    @property
    def time(self) -> float:
        """When it was measured (s)."""
        return self.innovation.time


class _Number:
    """One number of a topic over time."""

    def __init__(self, learned: Learned, limit: float, careful: float, *, is_steady: bool, is_position: bool):
        self.learned = learned
        self.sums = CumulativeSums()
        self.limit = max(limit, careful * learned.highest)
        self._block, self._sum, self._count, self._moving = -1, 0.0, 0, False
        self._last = float("nan")
        self._unsteady = Unsteadiness(learned.jitter)
        self._most_unsteady = max(_UNSTEADY, _MORE_UNSTEADY * learned.unsteady) if is_steady else float("inf")
        self._most_jump = max(_JUMP, 2 * learned.largest) if is_position else float("inf")
        self._jumped = 0.0
        self.repeats = 0

    def add(self, time: float, left: float, deviations: float, measured: float, *, moving: bool) -> None:
        block = int(time / BLOCK)
        if block != self._block:
            if self._count:
                self.sums.add(self._sum / self._count / self.learned.block[self._moving])
                self.sums.limit(2 * self.limit)
            self._block, self._sum, self._count = block, 0.0, 0
        self._sum += min(max(deviations, -MOST_DEVIATIONS), MOST_DEVIATIONS)
        self._jumped = 0.9 * self._jumped if abs(deviations) < self._most_jump else abs(deviations) / self._most_jump
        self._count += 1
        self._moving = moving
        self.repeats = self.repeats + 1 if measured == self._last else 0
        self._last = measured
        self._unsteady.add(left)

    @property
    def unsteady(self) -> float:
        """How much of the noise is too much; above one it is."""
        return self._unsteady.value / self._most_unsteady

    @property
    def is_frozen(self) -> bool:
        return self.repeats >= max(_REPEATS, 3 * self.learned.repeats)

    @property
    def excess(self) -> float:
        """How far it is on the way to an alarm; above one it is one."""
        frozen = 1.5 if self.is_frozen else 0.0
        return max(self.sums.highest / self.limit, self.unsteady, frozen, min(self._jumped, 2.0))


class Detector:
    """Judges the measurements of one robot.

    Args:
        profile: What was learned of it.
        topics: Its topics.
        time_to_false_alarm: The mean time (s) to a false alarm of white noise, for all its numbers together.
        stands: Whether the robot stands on the ground, so that efforts at rest say nothing.
    """

    def __init__(
        self, profile: Profile, topics: frozenset[str], time_to_false_alarm: float = 3600.0, *, stands: bool = False
    ):
        self._stands = stands
        self._surprised: dict[str, float] = {}  # joint → when its velocity was last far from the twin's
        own = {topic: known for topic, known in profile.topics.items() if topic in topics}
        self._differing = Differing()
        careful = (_ABOVE_ON_GROUND if stands else _ABOVE_HEALTHY) * (1.0 + _SHORT / max(profile.duration, 1.0))
        limit = threshold(2 * sum(map(len, own.values())), time_to_false_alarm)
        self._numbers = {
            topic: {
                name: _Number(
                    item, limit, careful, is_steady=not name.endswith(".effort"), is_position=name.endswith(".position")
                )
                for name, item in known.items()
            }
            for topic, known in own.items()
        }

    def judge(self, innovation: Innovation) -> Judged:
        """Judge a measurement."""
        numbers = self._numbers.get(innovation.watched.topic, {})
        readings: dict[str, Reading] = {}
        differences = self._differing.of(innovation).values
        for name, difference in differences.items():
            joint, _, kind = name.rpartition(".")
            if (
                kind == "velocity"
                and name in numbers
                and abs(difference) > _SURPRISE * max(numbers[name].learned.noise)
            ):
                self._surprised[joint] = innovation.time
        for name, difference in differences.items():
            number = numbers.get(name)
            if number is None:
                continue
            learned = number.learned
            explained = float(np.dot(learned.weights, features(innovation, name)))
            left = difference - explained
            moving = is_moving(innovation, name)
            if self._stands and not moving and name.endswith(".effort"):
                continue  # of wheels and feet at rest, the ground's friction holds what nobody can tell
            deviations = left / learned.noise[moving]
            joint, _, kind = name.rpartition(".")
            if kind == "position" and innovation.time - self._surprised.get(joint, -_CALM) < _CALM:
                deviations = float(np.clip(deviations, -MOST_DEVIATIONS, MOST_DEVIATIONS))  # a late command, no jump
            if not innovation.caught_up:
                number.add(innovation.time, left, deviations, innovation.measured[name], moving=moving)
            readings[name] = Reading(left, left / learned.spread[moving])
        return Judged(innovation, readings)

    def excess(self) -> tuple[float, str, str]:
        """Return how far the number that differs most is on its way to an alarm, at one; its topic and name."""
        found = [(number.excess, topic, name) for topic, own in self._numbers.items() for name, number in own.items()]
        return max(found, default=(0.0, "", ""))

    def frozen(self) -> list[tuple[str, str]]:
        """Return the numbers that repeat themselves: topics and names."""
        return [(topic, name) for topic, own in self._numbers.items() for name, n in own.items() if n.is_frozen]

    def jittery(self) -> list[tuple[str, str]]:
        """Return the numbers whose noise has risen: topics and names."""
        return [(topic, name) for topic, own in self._numbers.items() for name, n in own.items() if n.unsteady > 0.5]

    def noise(self) -> dict[str, float]:
        """Return the standard deviation of each number in the healthy run."""
        return {name: n.learned.spread[1] for own in self._numbers.values() for name, n in own.items()}

    def above(self) -> set[tuple[str, str]]:
        """Return the numbers that are an alarm: topics and names."""
        return {(topic, name) for topic, own in self._numbers.items() for name, n in own.items() if n.excess > 1.0}

    def began(self, time: float, numbers: Iterable[tuple[str, str]]) -> float:
        """Return when the change of some numbers began that is noticed at a time (s)."""
        found = (self._numbers[topic][name] for topic, name in numbers)
        blocks = [number.sums.blocks for number in found if number.sums.highest > number.limit]
        return time - BLOCK * (max(blocks, default=1) + 1)

    def levels(self) -> dict[str, float]:
        """Return for each number how far it is on its way to an alarm."""
        return {f"{topic} {name}": n.excess for topic, own in self._numbers.items() for name, n in own.items()}
