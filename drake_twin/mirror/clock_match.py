"""The robot's clock beside the listener's: offset, drift, and what arrives late, twice, or not at all.

A message is never heard before it was sent. So the differences between the times at which messages are heard and their
stamps lie above the line that the two clocks describe, and touch it where a message was not delayed: the line is the
edge of their lower convex hull (Moon, Skelly, Towsley: Estimation and removal of clock skew, INFOCOM 1999).
A constant delay of all messages cannot be told from an offset.
"""

from collections import deque
from itertools import pairwise
from math import inf

_BIN = 1.0  # s in which one difference, the least, is kept
_MOST_BINS = 600
_STEADY = 10.0  # s that are needed for a drift
_JUMP = 0.5  # s by which a clock that is set differs from before


class ClockMatch:
    """Matches the stamps of a robot to the times at which its messages are heard.

    Attributes:
        resets: How often the robot's clock was set: its stamps went back, or ahead, for good.
    """

    def __init__(self) -> None:
        self._least: deque[tuple[float, float]] = deque(maxlen=_MOST_BINS)  # the stamp and the difference of each bin
        self._bin = -inf
        self._offset, self._drift, self._zero = inf, 0.0, 0.0
        self._strays = 0
        self.resets = 0

    @property
    def offset(self) -> float:
        """How far the listener's clock is ahead of the robot's now (s), the shortest delay included."""
        return self._at(self._least[-1][0]) if self._least else 0.0

    @property
    def drift(self) -> float:
        """By how much faster the listener's clock runs; 1e-6 is one second in 11.6 days."""
        return self._drift

    def heard(self, received: float, stamp: float) -> float:
        """Take note of a message, and return when it was stamped on the listener's clock (s).

        Args:
            received: When it was heard (s), on the listener's clock.
            stamp: Its stamp (s), on the robot's clock.
        """
        difference = received - stamp
        if self._least and abs(difference - self._at(stamp)) > _JUMP:
            self._strays += 1
            if self._strays < 3:  # a message that was stuck, or bad
                return received
            self._least.clear()
            self._offset, self._drift, self._bin = inf, 0.0, -inf
            self.resets += 1
        self._strays = 0
        if stamp - self._bin >= _BIN or not self._least:
            self._bin = stamp
            self._least.append((stamp, difference))
            self._fit()
        elif difference < self._least[-1][1]:
            self._least[-1] = (stamp, difference)
            if difference < self._at(stamp):
                self._fit()
        return min(stamp + self._at(stamp), received)

    def _at(self, stamp: float) -> float:
        return self._offset + self._drift * (stamp - self._zero)

    def _fit(self) -> None:
        """Lay the line under the differences that lies closest below their middle."""
        points = list(self._least)
        self._zero = points[-1][0]
        if points[-1][0] - points[0][0] < _STEADY:
            self._drift, self._offset = 0.0, min(difference for _, difference in points)
            return
        middle = (points[0][0] + points[-1][0]) / 2
        hull: list[tuple[float, float]] = []
        for point in points:
            while len(hull) >= 2 and _turns_right(hull[-2], hull[-1], point):
                hull.pop()
            hull.append(point)
        for (t0, d0), (t1, d1) in pairwise(hull):
            if t1 >= middle:
                self._drift = (d1 - d0) / (t1 - t0)
                self._offset = d0 + self._drift * (self._zero - t0)
                return


def _turns_right(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> bool:
    return (b[0] - a[0]) * (c[1] - a[1]) <= (b[1] - a[1]) * (c[0] - a[0])


class Arrivals:
    """What arrives of one topic: its period, gaps, and messages out of order.

    Attributes:
        count: The number of messages.
        late: How many came after one with a later stamp.
        repeated: How many had the stamp of the one before.
        gaps: How often none came for longer than five periods and 0.1 s.
        longest_gap: The longest time between two (s).
        period: The median time between messages (s); zero of fewer than two.
    """

    def __init__(self) -> None:
        self.count = self.late = self.repeated = self.gaps = 0
        self.longest_gap = 0.0
        self._last = -inf
        self._spans: deque[float] = deque(maxlen=101)
        self.period = 0.0

    def add(self, time: float) -> None:
        """Take note of a message with a time (s)."""
        self.count += 1
        span = time - self._last
        if span < 0:
            self.late += 1
            return
        self._last = time
        if span == 0:
            self.repeated += 1
        elif span < inf:
            if self.period and span > self.longest_silence:
                self.gaps += 1
            self.longest_gap = max(self.longest_gap, span)
            self._spans.append(span)
            if len(self._spans) <= 20 or self.count % 20 == 0:
                self.period = sorted(self._spans)[len(self._spans) // 2]

    @property
    def longest_silence(self) -> float:
        """How long no message may come before that is a gap (s)."""
        return max(0.1, 5 * self.period)
