"""Limits of velocity, acceleration and jerk on a commanded speed."""

from math import isnan, nan

from drake_twin.dataclass import dataclass


@dataclass(frozen=True)
class SpeedLimiter:
    """Limits a commanded speed as ros2_controllers' drives do.

    The jerk limit comes first, then acceleration, then velocity, so that the later ones are never exceeded. A NaN
    maximum switches a limit off; a NaN minimum is the maximum's opposite. The behaviour is that of control_toolbox's
    ``RateLimiter`` in ROS 2 Jazzy: an acceleration may decrease at any jerk, because a limit on that too would let the
    speed oscillate about its target.

    Attributes:
        min_velocity: The smallest velocity, at most zero (m/s or rad/s).
        max_velocity: The largest velocity.
        max_acceleration_reverse: The strongest acceleration backwards, at most zero (m/s² or rad/s²).
        max_acceleration: The strongest acceleration forwards.
        max_deceleration: The strongest braking of a forward motion, at most zero; NaN for ``max_acceleration_reverse``.
        max_deceleration_reverse: The strongest braking of a backward motion; NaN for ``max_acceleration``.
        min_jerk: The smallest jerk, at most zero (m/s³ or rad/s³).
        max_jerk: The largest jerk.

    Raises:
        ValueError: If a minimum is above its maximum.
    """

    min_velocity: float = nan
    max_velocity: float = nan
    max_acceleration_reverse: float = nan
    max_acceleration: float = nan
    max_deceleration: float = nan
    max_deceleration_reverse: float = nan
    min_jerk: float = nan
    max_jerk: float = nan

    def __post_init__(self) -> None:
        for what, (lower, upper) in (
            ("velocity", self._velocities()),
            ("acceleration", self._accelerations(0.0)),
            ("deceleration", (self._accelerations(1.0)[0], self._accelerations(-1.0)[1])),
            ("jerk", self._jerks()),
        ):
            if lower > upper:
                raise ValueError(f"the {what} limits are in the wrong order: {lower:g} is above {upper:g}")

    def limited(self, speed: float, last: float, second_to_last: float, period: float) -> float:
        """Return the speed within the limits that is nearest to the commanded one.

        Args:
            speed: The commanded speed (m/s or rad/s).
            last: The output one period ago.
            second_to_last: The output two periods ago.
            period: The time between two updates (s).
        """
        change_before = last - second_to_last
        further = speed - last - change_before
        lower, upper = self._jerks()
        if not isnan(upper) and further * (speed - last) > 0.0:
            speed = last + change_before + _clamp(further, lower * period**2, upper * period**2)
        lower, upper = self._accelerations(last)
        if not isnan(upper):
            speed = last + _clamp(speed - last, lower * period, upper * period)
        lower, upper = self._velocities()
        return speed if isnan(upper) else _clamp(speed, lower, upper)

    def _velocities(self) -> tuple[float, float]:
        return _or(self.min_velocity, -self.max_velocity), self.max_velocity

    def _accelerations(self, last: float) -> tuple[float, float]:
        forward = self.max_acceleration
        if isnan(forward):  # as upstream: without it the other acceleration limits have no effect
            return nan, nan
        backward = _or(self.max_acceleration_reverse, -forward)
        if last > 0.0:
            return _or(self.max_deceleration, backward), forward
        if last < 0.0:
            return backward, _or(self.max_deceleration_reverse, forward)
        return backward, forward

    def _jerks(self) -> tuple[float, float]:
        return _or(self.min_jerk, -self.max_jerk), self.max_jerk


def _or(value: float, otherwise: float) -> float:
    return otherwise if isnan(value) else value


def _clamp(value: float, lower: float, upper: float) -> float:
    return min(max(value, lower), upper)
