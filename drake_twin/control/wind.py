"""A wind that rises to what is wanted of it and swings, as gz-sim's WindEffects has it."""

from collections.abc import Callable
from math import atan2, cos, degrees, exp, hypot, pi, radians, sin

from drake_twin.dataclass import dataclass
from drake_twin.frozen import Frozen
from drake_twin.saved import saved

Velocity = tuple[float, float, float]


@saved("WindState")
@dataclass(frozen=True)
class WindState(Frozen):
    """What a wind follows from since it was last told something.

    Attributes:
        time: When that was (s).
        wanted: The velocity that it rises to, in the world (m/s).
        speed: Its horizontal speed then, without what swings (m/s).
        direction: Its direction then, from x to y (degrees).
        vertical: Its vertical velocity then (m/s).
        blows: Whether it changes with time and exerts forces.
    """

    time: float
    wanted: Velocity
    speed: float
    direction: float
    vertical: float
    blows: bool = True


@dataclass(frozen=True)
class Swing:
    """How a quantity follows what is wanted of it.

    Attributes:
        rise: The time constant of its rise (s).
        amplitude: Of the sinusoid that is added to it.
        period: Of that (s).
        noise: Adds noise to a value at a time (s); None for none.
    """

    rise: float = 1.0
    amplitude: float = 0.0
    period: float = 1.0
    noise: Callable[[float, float], float] | None = None

    def swung(self, value: float, time: float, scale: float = 1.0) -> float:
        """Return a value with the sinusoid, times a scale, and the noise at a time (s)."""
        if self.amplitude:
            value += scale * self.amplitude * sin(2.0 * pi * time / self.period)
        return value if self.noise is None else self.noise(value, time)


class ChangingWind:
    """The velocity of a wind at any time.

    Each of horizontal speed, direction and vertical velocity follows a first-order filter from the last time at which
    something was wanted, in closed form, so that it depends neither on the step nor on when it is asked for. The speed
    and the vertical velocity begin at zero.

    Args:
        speed: How the horizontal speed follows; its amplitude is relative to the speed.
        direction: How the direction follows (degrees).
        vertical: How the vertical velocity follows; without a sinusoid.
    """

    def __init__(self, speed: Swing, direction: Swing, vertical: Swing):
        self._speed, self._direction, self._vertical = speed, direction, vertical

    def start(self, wanted: Velocity) -> WindState:
        """Return the state at time zero."""
        return WindState(0.0, wanted, 0.0, degrees(atan2(wanted[1], wanted[0])), 0.0)

    def told(self, state: WindState, time: float, wanted: Velocity | None, *, blows: bool) -> WindState:
        """Return the state after a velocity was wanted at a time (s); None for that of before.

        A wind that does not blow keeps the velocity that it has then.
        """
        speed, direction, vertical = self._followed(state, time)
        return WindState(time, state.wanted if wanted is None else wanted, speed, direction, vertical, blows)

    def velocity(self, state: WindState, time: float) -> Velocity:
        """Return the velocity in the world (m/s) at a time (s)."""
        time = time if state.blows else state.time
        speed, direction, vertical = self._followed(state, time)
        speed = self._speed.swung(speed, time, speed)
        angle = radians(self._direction.swung(direction, time))
        return speed * cos(angle), speed * sin(angle), self._vertical.swung(vertical, time)

    def _followed(self, state: WindState, time: float) -> tuple[float, float, float]:
        """Return speed, direction and vertical velocity at a time, without what swings."""
        if not state.blows:
            return state.speed, state.direction, state.vertical
        x, y, z = state.wanted
        past = time - state.time
        return (
            _after(past, self._speed, state.speed, hypot(x, y)),
            _after(past, self._direction, state.direction, degrees(atan2(y, x))),
            _after(past, self._vertical, state.vertical, z),
        )


def _after(past: float, swing: Swing, start: float, end: float) -> float:
    return end + (start - end) * exp(-past / swing.rise)
