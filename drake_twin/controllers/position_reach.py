"""The distance from its joint that a commanded position may have."""

from collections.abc import Sequence
from math import copysign, expm1, isnan

from drake_twin.dataclass import dataclass

# The lowest average speed of a joint that moves to a far position, relative to its velocity limit.
_LEAST_MEAN = 0.95


@dataclass(frozen=True)
class PositionReach:
    """Keep a joint's position servo within the joint's velocity limit.

    The servo moves at error / time constant, so that error is limited. Between two commands it slows down. If its time
    constant is so short that it would nearly stop, it may start faster, so that it moves at the limit on average.

    Attributes:
        position: The index of the position among the commands.
        velocity: The index of the velocity of the same joint; None without one.
        joint: The index of the joint's position in the robot's state.
        limit: The largest velocity at which the servo may start (rad/s or m/s).
        time_constant: The servo's time constant (s).
    """

    position: int
    velocity: int | None
    joint: int
    limit: float
    time_constant: float

    @classmethod
    def of_joint(
        cls,
        position: int,
        velocity: int | None,
        joint: int,
        *,
        velocity_limit: float,
        time_constant: float,
        period: float,
    ) -> "PositionReach":
        """Return the reach for a joint's velocity limit (rad/s or m/s) and the time between two commands (s)."""
        ratio = period / time_constant
        limit = velocity_limit * max(1.0, _LEAST_MEAN * ratio / -expm1(-ratio))
        return cls(position, velocity, joint, limit, time_constant)

    def limited(self, commands: Sequence[float], state: Sequence[float]) -> float:
        """Return the commanded position within its reach (rad or m).

        Args:
            commands: The commands of the controller; NaN where nothing is written.
            state: The robot's ``[q; v]``.
        """
        position, present, T = commands[self.position], state[self.joint], self.time_constant
        velocity = 0.0 if self.velocity is None or isnan(commands[self.velocity]) else commands[self.velocity]
        approach = (position - present) / T + velocity
        if -self.limit <= approach <= self.limit or isnan(position):
            return position
        return present + T * (copysign(self.limit, approach) - velocity)
