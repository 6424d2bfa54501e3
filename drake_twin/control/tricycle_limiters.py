"""The limits of tricycle_controller: one number for both directions, on its wheel and on its steering angle."""

from math import isnan, nan

from drake_twin.dataclass import dataclass

_NO_MAXIMUM = 1000.0  # upstream's stand-in for a maximum when only the minimum is given


@dataclass(frozen=True)
class TractionLimiter:
    """Limits the driven wheel's commanded speed, in both directions alike.

    As ``TractionLimiter`` of ros2_controllers' tricycle_controller, including the factor 2 of its jerk limit. Minima
    are real: a speed between zero and ``min_velocity`` becomes ``min_velocity``. NaN switches a limit off.

    Attributes:
        min_velocity: Smallest speed (rad/s); likewise for acceleration, deceleration (rad/s²) and jerk (rad/s³).

    Raises:
        ValueError: If a limit is negative, or a minimum is above its maximum.
    """

    min_velocity: float = nan
    max_velocity: float = nan
    min_acceleration: float = nan
    max_acceleration: float = nan
    min_deceleration: float = nan
    max_deceleration: float = nan
    min_jerk: float = nan
    max_jerk: float = nan

    def __post_init__(self) -> None:
        for what in ("velocity", "acceleration", "deceleration", "jerk"):
            _check(what, *self._limits(what))

    def limited(self, speed: float, last: float, second_to_last: float, period: float) -> float:
        """Return the speed (rad/s) within the limits nearest to the commanded one; see `SpeedLimiter.limited`."""
        speed = _near(speed, 2.0 * last - second_to_last, self._limits("jerk"), 2.0 * period**2)
        speed = _near(speed, last, self._limits("acceleration" if abs(speed) >= abs(last) else "deceleration"), period)
        return _near(speed, 0.0, self._limits("velocity"), 1.0)

    def _limits(self, what: str) -> tuple[float, float]:
        return _both(getattr(self, f"min_{what}"), getattr(self, f"max_{what}"))


@dataclass(frozen=True)
class SteeringLimiter:
    """Limits a commanded steering angle, as ``SteeringLimiter`` of tricycle_controller.

    Attributes:
        min_position: Smallest angle (rad); NaN for the maximum's opposite.
        max_position: Largest angle (rad).
        min_velocity: Smallest speed in either direction (rad/s).
        max_velocity: Largest speed.
        min_acceleration: Smallest acceleration in either direction (rad/s²).
        max_acceleration: Largest acceleration.

    Raises:
        ValueError: If a speed or acceleration is negative, or a minimum is above its maximum.
    """

    min_position: float = nan
    max_position: float = nan
    min_velocity: float = nan
    max_velocity: float = nan
    min_acceleration: float = nan
    max_acceleration: float = nan

    def __post_init__(self) -> None:
        lower, upper = self._positions()
        if lower > upper:
            raise ValueError(f"the position limits are in the wrong order: {lower:g} is above {upper:g}")
        _check("velocity", *_both(self.min_velocity, self.max_velocity))
        _check("acceleration", *_both(self.min_acceleration, self.max_acceleration))

    def limited(self, angle: float, last: float, second_to_last: float, period: float) -> float:
        """Return the angle (rad) within the limits nearest to the commanded one; see `SpeedLimiter.limited`."""
        accelerations = _both(self.min_acceleration, self.max_acceleration)
        angle = _near(angle, 2.0 * last - second_to_last, accelerations, 2.0 * period**2)
        angle = _near(angle, last, _both(self.min_velocity, self.max_velocity), period)
        lower, upper = self._positions()
        return angle if isnan(upper) else min(max(angle, lower), upper)

    def _positions(self) -> tuple[float, float]:
        lower, upper = self.min_position, self.max_position
        return (-upper if isnan(lower) else lower), (-lower if isnan(upper) else upper)


def _both(lower: float, upper: float) -> tuple[float, float]:
    if isnan(upper) and not isnan(lower):
        upper = _NO_MAXIMUM
    return (0.0 if isnan(lower) and not isnan(upper) else lower), upper


def _near(value: float, middle: float, limits: tuple[float, float], scale: float) -> float:
    """Return the value nearest to the wanted one whose distance from ``middle`` is within limits."""
    lower, upper = limits
    if isnan(upper):
        return value
    distance = min(max(abs(value - middle), lower * scale), upper * scale)
    return middle + (distance if value >= middle else -distance)


def _check(what: str, lower: float, upper: float) -> None:
    if lower < 0.0 or upper < 0.0:
        raise ValueError(f"a limit of {what} is negative; one number above zero holds in both directions")
    if lower > upper:
        raise ValueError(f"the {what} limits are in the wrong order: {lower:g} is above {upper:g}")
