"""How exactly a log measures: the standard deviation of each kind of number of a topic, given or estimated."""

from collections.abc import Mapping

import numpy as np

from drake_twin.calibration.log import Measured
from drake_twin.calibration.measured import UNITS, kind_of
from drake_twin.errors import InputError

_LEAST = 1e-4  # of the range of the numbers: what no measurement and no interpolation is better than
_MEDIAN = 0.6745  # of the absolute value of a standard normal number
_THIRD = 20**0.5  # standard deviation of third differences of white noise


def parse_noise(texts: list[str]) -> dict[str, float]:
    """Read ``NAME=VALUE``, where NAME is a kind of `UNITS` or a number's name.

    Raises:
        InputError: If a text is not one, or the value is not above zero.
    """
    found = {}
    for text in texts:
        name, _, value = text.partition("=")
        try:
            found[name.strip()] = float(value)
        except ValueError:
            raise InputError(f"--noise {text}: it must read NAME=VALUE, for example velocity=0.005") from None
        if not 0 < found[name.strip()] < np.inf:
            raise InputError(f"--noise {text}: the standard deviation must be above zero")
    return found


def noises(
    measured: Measured, given: Mapping[str, float], simulated: Mapping[str, np.ndarray] | None = None
) -> dict[str, float]:
    """Return the standard deviation of each number of a topic.

    An estimate is the median size of the third differences of all numbers of a kind, which motion that is smooth at
    the log's rate does not change, and jumps only where they are.

    Args:
        measured: The topic.
        given: Kind or name of a number → its standard deviation.
        simulated: What a twin has at the measurements' times, whose jumps do not count.
    """
    found: dict[str, float] = {}
    for kind in dict.fromkeys(map(kind_of, measured.series)):
        own = {name: series for name, series in measured.series.items() if kind_of(name) == kind}
        without = simulated or {}
        differences = [_third_differences(at, values - without.get(name, 0.0)) for name, (at, values) in own.items()]
        every = np.concatenate([item for item in differences if np.any(item)] or [np.zeros(1)])
        span = max(float(np.ptp(values)) for _, values in own.values())
        estimate = max(float(np.median(np.abs(every))) / _MEDIAN / _THIRD, _LEAST * span)
        for name in own:
            found[name] = given.get(name, given.get(kind, estimate))
    return found


def check_names(given: Mapping[str, float], names: set[str]) -> None:
    """Check the names for which standard deviations are given.

    Raises:
        InputError: If a name is neither a kind nor a number of a log.
    """
    for name in given:
        if name not in UNITS and name not in names:
            raise InputError("--noise: the logs have no such number", value=name, valid=[*UNITS, *sorted(names)])


def _third_differences(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the third differences of values, where their times have no gap; shape (N,), N may be zero."""
    if len(times) < 4:
        return np.zeros(0)
    spans = times[3:] - times[:-3]
    return np.asarray(np.diff(values, 3)[spans < 1.5 * np.median(spans)])
