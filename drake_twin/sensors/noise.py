"""The noise of sensors, as gz-sensors computes it (src/GaussianNoiseModel.cc), without a history.

Each number is a function of the seed, the robot, the sensor, the channel and the tick (Philox is a counter-based
generator): it does not depend on who listened before, on the order of subscriptions, or on a snapshot between.
"""

from dataclasses import replace
from functools import cached_property
from hashlib import blake2b
from math import exp, expm1, floor, sqrt
from typing import Any

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.description.sensor_element import SensorElement

_TYPES = ("none", "gaussian", "gaussian_quantized")
_ROUNDING = 1e-6  # relative to a tick: a step's time differs from k / rate by rounding
_FINEST = 1e-6  # gz-sensors takes a smaller precision for none
_WANDERING_TICK = 1e-3  # s, of a sensor without a rate: its ticks would change with the physics step


@dataclass(frozen=True)
class Noise:
    """The noise of one channel, in the channel's unit: ``value + bias + N(mean, stddev)``, rounded to ``precision``.

    Attributes:
        mean: The mean of the white noise.
        stddev: Its standard deviation.
        bias_mean: The mean of the bias, which is drawn once and whose sign is flipped with probability ½.
        bias_stddev: The standard deviation of the bias.
        dynamic_bias_stddev: The standard deviation of the bias's random walk (unit/√s).
        dynamic_bias_correlation_time: Its correlation time (s); 0 for a bias that does not wander.
        precision: The multiple to which the output is rounded; 0 for none.
    """

    mean: float = 0.0
    stddev: float = 0.0
    bias_mean: float = 0.0
    bias_stddev: float = 0.0
    dynamic_bias_stddev: float = 0.0
    dynamic_bias_correlation_time: float = 0.0
    precision: float = 0.0

    @property
    def wanders(self) -> bool:
        """Whether the bias changes with time."""
        return self.dynamic_bias_stddev > 0.0 and self.dynamic_bias_correlation_time > 0.0

    def scaled(self, factor: float) -> "Noise":
        """Return the noise times a factor: its means and standard deviations, not the precision; 0 for no noise."""
        if factor in (0.0, 1.0):
            return self if factor else SILENT
        return replace(
            self,
            mean=factor * self.mean,
            stddev=factor * self.stddev,
            bias_mean=factor * self.bias_mean,
            bias_stddev=factor * self.bias_stddev,
            dynamic_bias_stddev=factor * self.dynamic_bias_stddev,
        )

    @property
    def text(self) -> str:
        """The parameters that are not zero, for a person."""
        return ", ".join(f"{name} {value:g}" for name, value in vars(self).items() if value and name in _FIELDS)


SILENT = Noise()
_FIELDS = tuple(vars(SILENT))


def read_noise(element: SensorElement | None, path: str = "noise") -> Noise:
    """Read a ``<noise>`` element; no noise by default.

    Raises:
        InputError: If a value is not a finite number, a standard deviation is negative, or the type is unknown.
    """
    found = None if element is None else element.part(path)
    if found is None:
        return SILENT
    kind = found.attribute("type") or found.text("type") or "none"
    if kind not in _TYPES:
        raise found.error(f"unknown noise type {kind!r}", value=kind, valid=_TYPES)
    noise = Noise(
        found.number("mean", 0.0),
        found.number("stddev", 0.0, least=0.0),
        found.number("bias_mean", 0.0),
        found.number("bias_stddev", 0.0, least=0.0),
        found.number("dynamic_bias_stddev", 0.0, least=0.0),
        found.number("dynamic_bias_correlation_time", 0.0, least=0.0),
        found.number("precision", 0.0, least=0.0),
    )
    return SILENT if kind == "none" else noise


@dataclass(frozen=True)
class NoiseSettings:
    """What a sensor reads of its element where that is noise alone: channel → its noise."""

    noises: dict[str, Noise]


@dataclass(frozen=True)
class NoiseSource:
    """What the noise of a sensor is drawn from.

    Attributes:
        seed: The scenario's seed.
        robot: The robot's name.
        sensor: The sensor's name with its link or joint, unique on the robot.
        rate: The sensor's rate (Hz); 0 for one that measures at every step.
        time_step: The physics step (s).
        factor: What the noises are multiplied with; 0 for no noise at all.
    """

    seed: int = 0
    robot: str = ""
    sensor: str = ""
    rate: float = 0.0
    time_step: float = 1e-3
    factor: float = 1.0

    def channel(self, name: str, noise: Noise) -> "NoiseChannel":
        """Return the noise of a channel, such as ``angular_velocity.x``."""
        return NoiseChannel(noise.scaled(self.factor), self, name)

    def tick(self, time: float, period: float = 0.0) -> int:
        """Return the number of measurements before a time (s)."""
        return floor(time / (period or (1.0 / self.rate if self.rate else self.time_step)) + _ROUNDING)


class NoiseChannel:
    """The noise of one channel of a sensor.

    The wandering bias is gz-sensors' recursion ``b ← φ b + N(0, σ_b √(τ/2 (1 − φ²)))``, ``φ = exp(−dt/τ)``, drawn so
    that each tick can be had by itself: the values at 2ⁿ ticks follow from each other, those between from the two
    around them (a bridge of the same process, exact in distribution). The random numbers of a tick are its own.

    Args:
        noise: Its parameters.
        source: What it is drawn from.
        name: The channel's name.
    """

    def __init__(self, noise: Noise, source: NoiseSource, name: str):
        self._noise, self._source = noise, source
        self._name = name
        self._known: dict[int, float] = {}
        self._generator = np.random.Generator(np.random.Philox(key=0))

    def apply(self, value: Any, time: float) -> Any:
        """Return measured values with noise.

        Args:
            value: A number, or an array with white noise of its own for each element.
            time: The time of the measurement (s).
        """
        noise = self._noise
        if noise is SILENT:
            return value
        value = value + (self.bias(time) + noise.mean)
        if noise.stddev > 0.0:
            white = self._normals("white", self._source.tick(time), np.size(value))
            value = value + noise.stddev * (white.reshape(np.shape(value)) if np.ndim(value) else float(white[0]))
        if noise.precision > _FINEST:
            value = _rounded(value / noise.precision) * noise.precision
        return value

    def bias(self, time: float) -> float:
        """Return the bias at a time (s)."""
        if not self._noise.wanders:
            return self._first_bias
        period = 1.0 / self._source.rate if self._source.rate else _WANDERING_TICK
        return self._wandering(self._source.tick(time, period), period)

    @cached_property
    def _first_bias(self) -> float:
        noise = self._noise
        size, sign = self._normals("bias", 0, 2).tolist()
        bias = noise.bias_mean + noise.bias_stddev * size
        return float(-bias if sign < 0.0 else bias)

    def _wandering(self, tick: int, period: float) -> float:
        """Return the bias at a tick, and remember what it follows from: neighbours follow from nearly the same."""
        known, path = self._known, {0: self._first_bias}
        below, above = 0, 1
        while above <= tick:
            path[above] = known[above] if above in known else self._onward(path[below], above - below, above, period)
            below, above = above, above * 2
        if below != tick:
            path[above] = known[above] if above in known else self._onward(path[below], above - below, above, period)
        while below != tick:
            middle = (below + above) // 2
            if middle not in path:
                between = known.get(middle)
                path[middle] = (
                    self._between(path[below], path[above], above - middle, middle, period)
                    if (between is None)
                    else between
                )
            below, above = (middle, above) if middle <= tick else (below, middle)
        self._known = path
        return path[tick]

    def _onward(self, value: float, ticks: int, tick: int, period: float) -> float:
        decay, spread = self._after(ticks * period)
        return decay * value + sqrt(spread) * self._draw(tick)

    def _between(self, before: float, after: float, ticks: int, tick: int, period: float) -> float:
        decay, spread = self._after(ticks * period)
        weight = 1.0 + decay * decay
        return decay * (before + after) / weight + sqrt(spread / weight) * self._draw(tick)

    def _after(self, time: float) -> tuple[float, float]:
        """Return φ and the variance that a time (s) adds."""
        tau = self._noise.dynamic_bias_correlation_time
        return exp(-time / tau), -(self._noise.dynamic_bias_stddev**2) * tau / 2 * expm1(-2 * time / tau)

    def _draw(self, tick: int) -> float:
        return float(self._normals("wandering", tick, 1)[0])

    def _normals(self, purpose: str, tick: int, count: int) -> np.ndarray:
        """Return the normally distributed numbers of a tick."""
        generator = self._generator
        generator.bit_generator.state = {
            "bit_generator": "Philox",
            "state": {"counter": np.array([0, 0, 0, tick], dtype=np.uint64), "key": self._keys[purpose]},
            "buffer": np.zeros(4, dtype=np.uint64),
            "buffer_pos": 4,
            "has_uint32": 0,
            "uinteger": 0,
        }
        return generator.standard_normal(count)

    @cached_property
    def _keys(self) -> dict[str, np.ndarray]:
        source = self._source
        keys = {}
        for purpose in ("white", "bias", "wandering"):
            names = "\0".join((str(source.seed), source.robot, source.sensor, self._name, purpose))
            keys[purpose] = np.frombuffer(blake2b(names.encode(), digest_size=16).digest(), dtype="<u8").astype(
                np.uint64
            )
        return keys


def _rounded(value: Any) -> Any:
    """Round half away from zero, as std::round does."""
    return (
        np.copysign(np.floor(np.abs(value) + 0.5), value)
        if np.ndim(value)
        else float(np.copysign(np.floor(abs(value) + 0.5), value))
    )
