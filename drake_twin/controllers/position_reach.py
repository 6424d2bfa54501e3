"""How far from its joint a position may be that a controller writes at each of its updates."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import copysign, expm1, isnan

# A joint that moves to a far position has at least this share of its velocity limit on average.
_LEAST_MEAN = 0.95


@dataclass(frozen=True)
class PositionReach:
    """Keeps a joint's position servo within the joint's velocity limit.

    The servo moves at error / time constant, so that error is limited. Between two commands it becomes slower; where it
    is so quick that it would nearly stop, it may start faster, so that it moves at the limit on average.

    Attributes:
        position: the index of the position among the commands.
        velocity: that of the velocity that goes with it; None without one.
        joint: where the joint's position stands in the robot's state.
        limit: the largest velocity at which the servo may begin to move there (rad/s or m/s).
        time_constant: the servo's (s).
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
        """The reach for a joint's velocity limit (rad/s or m/s) and the time between two commands (s)."""
        ratio = period / time_constant
        limit = velocity_limit * max(1.0, _LEAST_MEAN * ratio / -expm1(-ratio))
        return cls(position, velocity, joint, limit, time_constant)

    def limited(self, commands: Sequence[float], state: Sequence[float]) -> float:
        """The commanded position (rad or m).

        Args:
            commands: what the controller would write; NaN where nothing.
            state: the robot's ``[q; v]``.
        """
        position, present, T = commands[self.position], state[self.joint], self.time_constant
        velocity = 0.0 if self.velocity is None or isnan(commands[self.velocity]) else commands[self.velocity]
        approach = (position - present) / T + velocity
        if -self.limit <= approach <= self.limit or isnan(position):
            return position
        return present + T * (copysign(self.limit, approach) - velocity)
