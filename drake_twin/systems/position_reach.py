"""How far from its joint a position may be that a controller writes at each of its updates."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import copysign, isnan


@dataclass(frozen=True)
class PositionReach:
    """Keeps a joint's position servo within the joint's velocity limit.

    The servo moves at error / time constant, so that error is limited. A stream of positions runs ahead of a joint that
    moves at its limit by as far as that moves between two; what is not beyond that is left alone.

    Attributes:
        position: the index of the position among the commands.
        velocity: that of the velocity that goes with it; None without one.
        joint: where the joint's position stands in the robot's state.
        limit: the joint's velocity limit (rad/s or m/s).
        time_constant: of the servo (s).
        period: the time between two commands (s).
    """

    position: int
    velocity: int | None
    joint: int
    limit: float
    time_constant: float
    period: float

    def limited(self, commands: Sequence[float], state: Sequence[float]) -> float:
        """The commanded position (rad or m).

        Args:
            commands: what the controller would write; NaN where nothing.
            state: the robot's ``[q; v]``.
        """
        T, position, present = self.time_constant, commands[self.position], float(state[self.joint])
        velocity = 0.0 if self.velocity is None or isnan(commands[self.velocity]) else commands[self.velocity]
        approach = (position - present) / T + velocity
        if isnan(position) or abs(approach) <= self.limit * (1 + self.period / T):
            return position
        return present + T * (copysign(self.limit, approach) - velocity)
