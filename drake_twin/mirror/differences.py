"""What a measurement differs from the twin by, where a command that comes a little later does not count."""

from collections import deque
from collections.abc import Mapping
from math import exp

from drake_twin.dataclass import dataclass
from drake_twin.mirror.follower import Innovation

_TIMES = 3  # measurements, of which a number may be the twin's at any: two periods late, at most
_EARLIER = 0.015  # s by which a command may come earlier or later than it is heard
_FOLLOWED = 0.1  # s in which the twin follows a position
_TOLERANT = ("velocity", "effort", "linear.x", "linear.y", "angular.z")


@dataclass(frozen=True)
class Differences:
    """A measurement beside the twin.

    Attributes:
        innovation: The measurement.
        values: Name of a number → by how much it was measured above what the twin had.
    """

    innovation: Innovation
    values: Mapping[str, float]


class Differing:
    """Turns measurements into differences; it remembers the last ones.

    Speeds and efforts jump when a command comes, and a real robot hears it some milliseconds earlier or later. So what
    lies between the twin's values at the last three measurements does not count as a difference; neither does the way
    that a joint makes in that time, until the twin has followed.
    """

    def __init__(self) -> None:
        self._last: dict[tuple[str, str], deque[float]] = {}
        self._ways: dict[tuple[str, str], tuple[float, float]] = {}  # when, and how far a position may be off

    def of(self, innovation: Innovation) -> Differences:
        """Return the differences of a measurement."""
        topic, own = innovation.watched.topic, innovation.predicted
        spans = {name: self._span(topic, name, value) for name, value in own.items() if name.endswith(_TOLERANT)}
        found: dict[str, float] = {}
        for name, value in innovation.measured.items():
            joint, _, kind = name.rpartition(".")
            if name in spans:
                found[name] = value - min(max(value, spans[name][0]), spans[name][1])
            elif kind == "position":
                way = self._way(innovation.time, topic, joint, *spans[f"{joint}.velocity"])
                found[name] = value - min(max(value, own[name] - way), own[name] + way)
            else:
                found[name] = value - own[name]
        return Differences(innovation, found)

    def _span(self, topic: str, name: str, now: float) -> tuple[float, float]:
        last = self._last.setdefault((topic, name), deque(maxlen=_TIMES))
        last.append(now)
        return min(last), max(last)

    def _way(self, time: float, topic: str, joint: str, slowest: float, fastest: float) -> float:
        before, way = self._ways.get((topic, joint), (time, 0.0))
        way = max(way * exp(-(time - before) / _FOLLOWED), (fastest - slowest) * _EARLIER)
        self._ways[topic, joint] = time, way
        return way
