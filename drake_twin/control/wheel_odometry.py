"""Where a base on wheels is, reckoned from what its wheels did."""

from dataclasses import dataclass, replace
from math import cos, sin

from drake_twin.saved import saved

_SHORTEST_INTERVAL = 1e-4  # s; as upstream: no speed is estimated over less


@saved("WheelOdometry")
@dataclass(frozen=True)
class WheelOdometry:
    """A base's pose and velocity in its odometry frame; values do not change, each step makes a new one.

    Attributes:
        x: position (m).
        y: position (m).
        heading: angle about z (rad), not wrapped.
        linear_x: velocity forwards in the base's own frame (m/s).
        linear_y: velocity to the left in the base's own frame (m/s).
        angular_z: velocity about z (rad/s).
        time: the time of this value (s).
        samples: the last (linear, angular) velocities, newest last, over which the velocity is averaged.
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
        """Whether enough time has passed for another step."""
        return time - self.time >= _SHORTEST_INTERVAL

    def moved(self, linear: float, angular: float, time: float, window: int = 1) -> "WheelOdometry":
        """A step at a constant velocity, on an arc; the reported velocity is the mean of the last ones.

        Args:
            linear: velocity forwards since the last step (m/s).
            angular: velocity about z since the last step (rad/s).
            time: the present time (s); nothing happens when it is less than 0.1 ms after the last step.
            window: how many velocities are averaged.
        """
        if not self.is_due(time):
            return self
        step = time - self.time
        x, y, heading = integrate_exactly(self.x, self.y, self.heading, linear * step, angular * step)
        samples = (*self.samples, (linear, angular))[-max(window, 1) :]
        mean_linear, mean_angular = (sum(values) / len(samples) for values in zip(*samples, strict=True))
        return WheelOdometry(x, y, heading, mean_linear, 0.0, mean_angular, time, samples)

    def moved_open_loop(self, linear: float, angular: float, time: float) -> "WheelOdometry":
        """A step at a commanded velocity, which is taken to be the real one and is not averaged."""
        step = time - self.time
        x, y, heading = integrate_exactly(self.x, self.y, self.heading, linear * step, angular * step)
        return replace(self, x=x, y=y, heading=heading, linear_x=linear, linear_y=0.0, angular_z=angular, time=time)

    def moved_sideways_too(self, linear_x: float, linear_y: float, angular: float, time: float) -> "WheelOdometry":
        """A step of a base that can move in all directions: Euler's, with the heading at its end, as upstream's."""
        if not self.is_due(time):
            return self
        step = time - self.time
        heading = self.heading + angular * step
        x = self.x + (linear_x * cos(heading) - linear_y * sin(heading)) * step
        y = self.y + (linear_x * sin(heading) + linear_y * cos(heading)) * step
        return WheelOdometry(x, y, heading, linear_x, linear_y, angular, time)

    def reset(self) -> "WheelOdometry":
        """The same velocities and time at the origin."""
        return replace(self, x=0.0, y=0.0, heading=0.0)


def integrate_exactly(x: float, y: float, heading: float, distance: float, turn: float) -> tuple[float, float, float]:
    """A pose moved along an arc; along a straight line (`integrate_by_midpoint`) where the turn is below 1e-6 rad."""
    if abs(turn) < 1e-6:
        return integrate_by_midpoint(x, y, heading, distance, turn)
    radius, after = distance / turn, heading + turn
    return x + radius * (sin(after) - sin(heading)), y - radius * (cos(after) - cos(heading)), after


def integrate_by_midpoint(
    x: float, y: float, heading: float, distance: float, turn: float
) -> tuple[float, float, float]:
    """A pose moved by one Runge-Kutta step of second order (distance in m, turn in rad)."""
    between = heading + 0.5 * turn
    return x + distance * cos(between), y + distance * sin(between), heading + turn
