"""The low-pass filter of control_toolbox."""

from math import exp, pi

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.saved import saved


@saved("LowPassMemory")
@dataclass(frozen=True)
class LowPassMemory:
    """What a filter keeps from one sample to the next.

    Attributes:
        value: The last input.
        filtered: The last output.
    """

    value: tuple[float, ...] = ()
    filtered: tuple[float, ...] = ()


@dataclass(frozen=True)
class LowPassFilter:
    """``filtered[n] = (1 - a)·value[n-1] + a·filtered[n-1]``, for each element.

    As control_toolbox's ``LowPassFilter`` (Jazzy): ``a = exp(-2π·damping_frequency / sampling_frequency /
    10^(-damping_intensity/10))``. An element starts at its first value, and starts again after it was NaN.

    Attributes:
        sampling_frequency: The rate of the samples (Hz).
        damping_frequency: The cut-off frequency, where the intensity is 0 (Hz).
        damping_intensity: The intensity (dB).
    """

    sampling_frequency: float
    damping_frequency: float
    damping_intensity: float

    @property
    def feedback(self) -> float:
        """The coefficient ``a``."""
        scale = 10.0 ** (self.damping_intensity / -10.0)
        return exp(-2.0 * pi * self.damping_frequency / self.sampling_frequency / scale)

    def update(self, value: np.ndarray, memory: LowPassMemory) -> tuple[np.ndarray, LowPassMemory]:
        """Filter one sample.

        Args:
            value: The input.
            memory: The memory after the last sample; ``LowPassMemory()`` at first.

        Returns:
            The filtered value, and the new memory.
        """
        last, filtered = (np.array(item or [np.nan] * len(value)) for item in (memory.value, memory.filtered))
        filtered = (1.0 - self.feedback) * last + self.feedback * filtered
        filtered = np.where(np.isnan(filtered), value, filtered)
        return filtered, LowPassMemory(tuple(value.tolist()), tuple(filtered.tolist()))
