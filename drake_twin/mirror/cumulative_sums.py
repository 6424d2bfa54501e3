"""Cumulative sums that tell a change from noise: Page's CUSUM, of both signs.

    S⁺ ← max(0, S⁺ + z − k),  S⁻ ← max(0, S⁻ − z − k),  an alarm where one is above h

z are means over blocks, in standard deviations. k = 3/2 is the best choice against a change by three standard
deviations: a model's own errors are of one for a while, and faults are larger. Of white noise the mean number of blocks
to a false alarm of one sum is (exp(2 k b) − 2 k b − 1) / (2 k²) with b = h + 1.166 (Siegmund: Sequential Analysis,
1985). A single block counts as five standard deviations at most, which is below every threshold.
"""

from collections.abc import Iterable, Iterator
from math import exp, log

BLOCK = 0.1  # s
REFERENCE = 1.5  # k
MOST = 5.0  # standard deviations that a block counts


def false_alarm_blocks(threshold: float) -> float:
    """Return the mean number of blocks of white noise to a false alarm of one sum."""
    twice = 2 * REFERENCE * (threshold + 1.166)
    return (exp(twice) - twice - 1) / (2 * REFERENCE**2)


def threshold(sums: int, time: float) -> float:
    """Return the threshold at which so many sums together raise one false alarm in a time (s); two blocks at least.

    Args:
        sums: How many sums are watched, of either sign.
        time: The mean time to a false alarm of white noise (s).
    """
    blocks = max(sums, 1) * time / BLOCK
    low, high = 0.0, log(blocks + 2.0) / REFERENCE + 10.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if false_alarm_blocks(middle) < blocks else (low, middle)
    return max(high, 1.01 * (MOST - REFERENCE))


def cumulative_sums(values: Iterable[float]) -> Iterator[tuple[float, float]]:
    """Yield S⁺ and S⁻ after each of the values (standard deviations)."""
    sums = CumulativeSums()
    for value in values:
        sums.add(value)
        yield sums.above, sums.below


class CumulativeSums:
    """S⁺ and S⁻ of one number.

    Attributes:
        above: S⁺.
        below: S⁻.
    """

    def __init__(self) -> None:
        self.above = self.below = 0.0
        self._since_above = self._since_below = 0

    def add(self, value: float) -> None:
        """Add a block (standard deviations)."""
        value = min(max(value, -MOST), MOST)
        self.above = max(0.0, self.above + value - REFERENCE)
        self.below = max(0.0, self.below - value - REFERENCE)
        self._since_above = self._since_above + 1 if self.above else 0
        self._since_below = self._since_below + 1 if self.below else 0

    @property
    def highest(self) -> float:
        """The higher of the two."""
        return max(self.above, self.below)

    @property
    def blocks(self) -> int:
        """How many blocks ago the higher of the two left zero: when a change began."""
        return self._since_above if self.above >= self.below else self._since_below

    def limit(self, most: float) -> None:
        """Bound both, so that an alarm ends soon after its cause."""
        self.above, self.below = min(self.above, most), min(self.below, most)
