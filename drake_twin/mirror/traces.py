"""The differences of a run over time, in a memory that does not grow: for the report and the page."""

from collections.abc import Iterator

from drake_twin.mirror.detector import Judged

_MOST = 600  # points of a number


class Trace:
    """One number over time: the least and the largest of its deviations in bins that become longer with the run.

    Attributes:
        width: The length of a bin (s).
        bins: Number of a bin → the least and the largest deviation in it (standard deviations).
    """

    def __init__(self) -> None:
        self.width = 0.1
        self.bins: dict[int, tuple[float, float]] = {}

    def add(self, time: float, deviation: float) -> None:
        """Add a deviation at a time (s)."""
        self._put(int(time / self.width), deviation, deviation)
        if len(self.bins) > _MOST:
            self.width *= 2
            old, self.bins = self.bins, {}
            for index, (low, high) in old.items():
                self._put(index // 2, low, high)

    def _put(self, index: int, low: float, high: float) -> None:
        before = self.bins.get(index, (low, high))
        self.bins[index] = min(low, before[0]), max(high, before[1])


class Traces:
    """The deviations of all numbers of a run.

    Attributes:
        of: Robot and name of a number, with its topic → its trace.
    """

    def __init__(self) -> None:
        self.of: dict[tuple[str, str, str], Trace] = {}

    def add(self, judged: Judged) -> None:
        """Add a measurement."""
        watched = judged.innovation.watched
        for name, reading in judged.readings.items():
            key = watched.robot, watched.topic, name
            if key not in self.of:
                self.of[key] = Trace()
            self.of[key].add(judged.time, reading.deviations)

    def __iter__(self) -> Iterator[tuple[tuple[str, str, str], Trace]]:
        return iter(sorted(self.of.items()))
