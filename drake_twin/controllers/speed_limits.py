"""Limits of a commanded speed, as parameters of drives."""

from collections.abc import Iterator
from dataclasses import field, fields
from math import nan
from typing import Any

from drake_twin.control.speed_limiter import SpeedLimiter
from drake_twin.dataclass import dataclass
from drake_twin.description.parameters import ParameterError

_AT_LEAST_ZERO = {"lower": 0.0}
_AT_MOST_ZERO = {"upper": 0.0}
_AXES = ("x", "y", "z")


@dataclass(frozen=True)
class SpeedLimits:
    """Limits of one component of a commanded velocity; NaN for no limit, and a NaN minimum is minus the maximum.

    Attributes:
        has_velocity_limits: False switches the velocity limits off; deprecated upstream.
        has_acceleration_limits: False switches the acceleration limits off; deprecated upstream.
        has_jerk_limits: False switches the jerk limits off; deprecated upstream.
        max_velocity: The highest velocity (m/s or rad/s).
        min_velocity: The lowest velocity, at most zero (m/s or rad/s).
        max_acceleration: The acceleration of a forward motion (m/s² or rad/s²).
        max_deceleration: The deceleration of a forward motion, at most zero (m/s² or rad/s²).
        min_acceleration: A parameter of Humble.
        max_acceleration_reverse: The acceleration of a backward motion, at most zero (m/s² or rad/s²).
        max_deceleration_reverse: The deceleration of a backward motion (m/s² or rad/s²).
        max_jerk: The highest jerk while the speed increases in magnitude (m/s³ or rad/s³).
        min_jerk: The lowest jerk, at most zero (m/s³ or rad/s³).
    """

    has_velocity_limits: bool = True
    has_acceleration_limits: bool = True
    has_jerk_limits: bool = True
    max_velocity: float = field(default=nan, metadata=_AT_LEAST_ZERO)
    min_velocity: float = field(default=nan, metadata=_AT_MOST_ZERO)
    max_acceleration: float = field(default=nan, metadata=_AT_LEAST_ZERO)
    max_deceleration: float = field(default=nan, metadata=_AT_MOST_ZERO)
    min_acceleration: float = field(
        default=nan,
        metadata={"unsupported": "ros2_controllers reads max_acceleration_reverse and max_deceleration since Jazzy"},
    )
    max_acceleration_reverse: float = field(default=nan, metadata=_AT_MOST_ZERO)
    max_deceleration_reverse: float = field(default=nan, metadata=_AT_LEAST_ZERO)
    max_jerk: float = field(default=nan, metadata=_AT_LEAST_ZERO)
    min_jerk: float = field(default=nan, metadata=_AT_MOST_ZERO)

    def __post_init__(self) -> None:
        try:
            self.limiter()
        except ValueError as error:
            raise ParameterError(str(error)) from None

    @property
    def never_moves(self) -> bool:
        """Whether both jerk limits are 0, with which ROS 2 Jazzy's speed never leaves 0.

        They are files of Humble, whose controllers apply no jerk limit without ``has_jerk_limits``.
        """
        return self.max_jerk == 0.0 and not self.min_jerk < 0.0

    def limiter(self) -> SpeedLimiter:
        """Return the limiter that applies these limits."""
        limits: dict[str, float] = {}
        if self.has_velocity_limits:
            limits |= {"min_velocity": self.min_velocity, "max_velocity": self.max_velocity}
        if self.has_acceleration_limits:
            limits |= {
                "max_acceleration_reverse": self.max_acceleration_reverse,
                "max_acceleration": self.max_acceleration,
                "max_deceleration": self.max_deceleration,
                "max_deceleration_reverse": self.max_deceleration_reverse,
            }
        if self.has_jerk_limits and not self.never_moves:
            limits |= {"min_jerk": self.min_jerk, "max_jerk": self.max_jerk}
        return SpeedLimiter(**limits)


def zero_jerk_limits(parameters: Any) -> Iterator[str]:
    """Yield a warning for each jerk limit of a drive's parameters that is not applied because it is 0."""
    for limits in fields(parameters):
        for axis in _AXES:
            speed = getattr(getattr(parameters, limits.name), axis, None)
            if isinstance(speed, SpeedLimits) and speed.has_jerk_limits and speed.never_moves:
                yield (
                    f"{limits.name}.{axis}.max_jerk is 0, with which it never moves in ROS 2 Jazzy: no jerk limit is"
                    " applied, as in Humble without has_jerk_limits"
                )


@dataclass(frozen=True)
class LimitsX:
    """Limits of a velocity along x.

    Attributes:
        x: The forward limits.
    """

    x: SpeedLimits = SpeedLimits()


@dataclass(frozen=True)
class LimitsXY:
    """Limits of a velocity in the plane.

    Attributes:
        x: The forward limits.
        y: The limits to the left.
    """

    x: SpeedLimits = SpeedLimits()
    y: SpeedLimits = SpeedLimits()


@dataclass(frozen=True)
class LimitsZ:
    """Limits of a velocity about z.

    Attributes:
        z: The limits, counterclockwise seen from above.
    """

    z: SpeedLimits = SpeedLimits()
