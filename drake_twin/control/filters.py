"""Filters of one number, as ``filters`` and ``control_filters`` have them for ROS 2's filter chains.

A filter is immutable: it takes what it kept of the sample before, ``()`` before the first one, and returns what it
keeps of this one.
"""

from math import fsum
from typing import Protocol

import numpy as np

from drake_twin.control.low_pass_filter import LowPassFilter, LowPassMemory
from drake_twin.control.speed_limiter import SpeedLimiter
from drake_twin.dataclass import dataclass

FilterMemory = tuple[float, ...]


class Filter(Protocol):
    """A filter of one number."""

    def update(self, value: float, memory: FilterMemory) -> tuple[float, FilterMemory]:
        """Return the filtered value, and what to keep for the next sample."""


@dataclass(frozen=True)
class MeanFilter:
    """The mean of the last values, of fewer at first; ``filters/MeanFilterDouble``.

    Attributes:
        count: The number of values.
    """

    count: int

    def update(self, value: float, memory: FilterMemory) -> tuple[float, FilterMemory]:
        """Return the mean."""
        values = (*memory, value)[-self.count :]
        return fsum(values) / len(values), values


@dataclass(frozen=True)
class ExponentialFilter:
    """``alpha`` · value + (1 - ``alpha``) · last output; ``control_filters/ExponentialFilterDouble``.

    Attributes:
        alpha: The share of a new value, from 0 to 1; the first value is taken whole.
    """

    alpha: float

    def update(self, value: float, memory: FilterMemory) -> tuple[float, FilterMemory]:
        """Return the smoothed value."""
        (last,) = memory or (value,)
        smoothed = self.alpha * value + (1.0 - self.alpha) * last
        return smoothed, (smoothed,)


@dataclass(frozen=True)
class LowPass:
    """The low-pass filter of control_toolbox; ``control_filters/LowPassFilterDouble``.

    Attributes:
        filter: The filter.
    """

    filter: LowPassFilter

    def update(self, value: float, memory: FilterMemory) -> tuple[float, FilterMemory]:
        """Return the filtered value."""
        before = LowPassMemory(memory[:1], memory[1:])
        (filtered,), after = self.filter.update(np.array([value]), before)
        return float(filtered), (*after.value, *after.filtered)


@dataclass(frozen=True)
class RateLimiter:
    """Limits of a value and of its first two derivatives; ``control_filters/RateLimiterDouble``.

    Attributes:
        limiter: The limits; its velocity is the value.
        interval: The time between two samples (s).
    """

    limiter: SpeedLimiter
    interval: float

    def update(self, value: float, memory: FilterMemory) -> tuple[float, FilterMemory]:
        """Return the limited value."""
        last, second_to_last = memory or (value, value)
        limited = self.limiter.limited(value, last, second_to_last, self.interval)
        return limited, (limited, last)
