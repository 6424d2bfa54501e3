"""Odometry from the motion of wheels."""

from dataclasses import replace
from math import cos, fsum, sin

from drake_twin.dataclass import dataclass
from drake_twin.saved import saved

_SHORTEST_INTERVAL = 1e-4  # s; as upstream: no speed is estimated over less


@saved("WheelOdometry")
@dataclass(frozen=True)
class WheelOdometry:
    """A base's pose and velocity in its odometry frame; immutable, each step returns a new one.

    Attributes:
        x: Position (m).
        y: Position (m).
        heading: Angle about z (rad), not wrapped.
        linear_x: Velocity forwards in the base's own frame (m/s).
        linear_y: Velocity to the left in the base's own frame (m/s).
        angular_z: Velocity about z (rad/s).
        time: The time of this value (s).
        samples: The last (linear, angular) velocities, newest last, over which the velocity is averaged.
    """

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0
    linear_x: float = 0.0
    linear_y: float = 0.0
    angular_z: float = 0.0
    time: float = 0.0
    samples: tuple[tuple[float, float], ...] = ()

    def is_due(self, time: float) -> bool:
        """Tell whether enough time has passed for another step."""
        return time - self.time >= _SHORTEST_INTERVAL

    def moved(self, linear: float, angular: float, time: float, window: int = 1) -> "WheelOdometry":
        """Return the odometry after a step at a constant velocity, on an arc; its velocity is the mean of the last
        ones.

        Args:
            linear: Velocity forwards since the last step (m/s).
            angular: Velocity about z since the last step (rad/s).
            time: The present time (s); nothing changes when it is less than 0.1 ms after the last step.
            window: The number of velocities to average.
        """
        if not self.is_due(time):
            return self
        step = time - self.time
        x, y, heading = integrate_exactly(self.x, self.y, self.heading, linear * step, angular * step)
        samples = (*self.samples, (linear, angular))[-max(window, 1) :]
        mean_linear, mean_angular = (fsum(values) / len(samples) for values in zip(*samples, strict=True))
        return WheelOdometry(x, y, heading, mean_linear, 0.0, mean_angular, time, samples)

    def moved_open_loop(self, linear: float, angular: float, time: float) -> "WheelOdometry":
        """Return the odometry after a step at a commanded velocity, taken as the real one and not averaged."""
        step = time - self.time
        x, y, heading = integrate_exactly(self.x, self.y, self.heading, linear * step, angular * step)
        return replace(self, x=x, y=y, heading=heading, linear_x=linear, linear_y=0.0, angular_z=angular, time=time)

    def moved_sideways_too(self, linear_x: float, linear_y: float, angular: float, time: float) -> "WheelOdometry":
        """Return the odometry after an Euler step in any direction, with the heading at its end, as upstream."""
        if not self.is_due(time):
            return self
        step = time - self.time
        heading = self.heading + angular * step
        x = self.x + (linear_x * cos(heading) - linear_y * sin(heading)) * step
        y = self.y + (linear_x * sin(heading) + linear_y * cos(heading)) * step
        return WheelOdometry(x, y, heading, linear_x, linear_y, angular, time)

    def moved_on_an_arc(self, linear_x: float, linear_y: float, angular: float, time: float) -> "WheelOdometry":
        """Return the odometry after a step at a constant velocity in any direction, on an arc, not averaged."""
        if not self.is_due(time):
            return self
        step = time - self.time
        motion = (linear_x * step, angular * step, linear_y * step)
        x, y, heading = integrate_exactly(self.x, self.y, self.heading, *motion)
        return WheelOdometry(x, y, heading, linear_x, linear_y, angular, time)

    def reset(self) -> "WheelOdometry":
        """Return the same velocities and time at the origin."""
        return replace(self, x=0.0, y=0.0, heading=0.0)


def integrate_exactly(
    x: float, y: float, heading: float, distance: float, turn: float, sideways: float = 0.0
) -> tuple[float, float, float]:
    """Move a pose along an arc; along a straight line (`integrate_by_midpoint`) where the turn is below 1e-6 rad.

    Args:
        x: Position (m).
        y: Position (m).
        heading: Angle about z (rad).
        distance: The motion forwards (m).
        turn: The turn about z (rad).
        sideways: The motion to the left (m).
    """
    if abs(turn) < 1e-6:
        return integrate_by_midpoint(x, y, heading, distance, turn, sideways)
    after = heading + turn
    along, across = (sin(after) - sin(heading)) / turn, (cos(after) - cos(heading)) / turn
    return x + distance * along + sideways * across, y - distance * across + sideways * along, after


def integrate_by_midpoint(
    x: float, y: float, heading: float, distance: float, turn: float, sideways: float = 0.0
) -> tuple[float, float, float]:
    """Move a pose by one Runge-Kutta step of second order (distance and motion to the left in m, turn in rad)."""
    between = heading + 0.5 * turn
    along, across = cos(between), sin(between)
    return x + distance * along - sideways * across, y + distance * across + sideways * along, heading + turn
