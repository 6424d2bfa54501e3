"""Trajectories of joints, and their samples as joint_trajectory_controller computes them."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import replace
from math import isnan, pi

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.saved import saved

INTERPOLATION_METHODS = ("splines", "none")

# ROS counts nanoseconds: a time this close before a point is at the point (s).
SAME_TIME = 0.5e-9


@saved("TrajectoryPoint")
@dataclass(frozen=True)
class TrajectoryPoint:
    """Positions (rad or m) and their derivatives, and efforts (N·m or N); each empty where it is not given."""

    positions: tuple[float, ...] = ()
    velocities: tuple[float, ...] = ()
    accelerations: tuple[float, ...] = ()
    effort: tuple[float, ...] = ()


@saved("Trajectory")
@dataclass(frozen=True)
class Trajectory:
    """The content of a ``trajectory_msgs/msg/JointTrajectory``, in the controller's order of joints.

    Attributes:
        points: Its points; the position of a joint that the message left out is NaN.
        times: The time of each point from the start (s), increasing.
        start: The simulation time of the start (s); None to start when it is accepted.
    """

    points: tuple[TrajectoryPoint, ...]
    times: tuple[float, ...]
    start: float | None = None

    def with_missing_positions(self, positions: Sequence[float]) -> "Trajectory":
        """Return the same, with joints that the message left out at their place in ``positions``."""
        if not any(isnan(position) for point in self.points for position in point.positions):
            return self
        points = tuple(
            replace(
                point,
                positions=tuple(
                    float(held) if isnan(position) else position
                    for position, held in zip(point.positions, positions, strict=bool(point.positions))
                ),
            )
            for point in self.points
        )
        return replace(self, points=points)


@dataclass(frozen=True)
class TrajectorySample:
    """A trajectory at a time.

    Attributes:
        point: The state, complete: what is not given is zero.
        is_over: Whether the last point has been reached.
        time_since_point: The time since the last point that has been reached (s); negative before the first one.
    """

    point: TrajectoryPoint
    is_over: bool
    time_since_point: float


@saved("RunningTrajectory")
@dataclass(frozen=True)
class RunningTrajectory:
    """An accepted trajectory: its points are complete, and it has a state before its first point.

    Attributes:
        start: The simulation time of the trajectory's start (s).
        times: The time of each point from the start (s).
        firsts: The first state of the segment that ends at the point of the same index.
        lasts: The last state of that segment.
        taken_up: The time from the start at which the first segment begins (s).
        interpolation_method: One of `INTERPOLATION_METHODS`.
        turns: Whole turns of each joint that wraps around, from the trajectory's positions to the joint's own (rad).
    """

    start: float
    times: tuple[float, ...]
    firsts: tuple[TrajectoryPoint, ...]
    lasts: tuple[TrajectoryPoint, ...]
    taken_up: float
    interpolation_method: str
    turns: tuple[float, ...]

    def sample(self, time: float) -> TrajectorySample:
        """Return the state at a simulation time (s); before the first segment, the state at its begin."""
        elapsed = max(time - self.start, self.taken_up)  # a slowed-down trajectory lags behind an update
        index = bisect_right(self.times, elapsed + SAME_TIME)  # the first point that has not been reached
        size = len(self.lasts[0].positions)
        if index == len(self.times):
            return TrajectorySample(_complete(self.lasts[-1], size), True, elapsed - self.times[-1])
        since = elapsed - self.times[max(index - 1, 0)]
        first, last = self.firsts[index], self.lasts[index]
        begin = self.times[index - 1] if index > 0 else self.taken_up
        if self.interpolation_method == "none":
            point = _complete(last if index > 0 else first, size)
        else:
            point = interpolate(first, last, self.times[index] - begin, elapsed - begin)
        return TrajectorySample(point, False, since)


def take_up(
    trajectory: Trajectory,
    time: float,
    state: TrajectoryPoint,
    wraparound: Sequence[bool] = (),
    interpolation_method: str = "splines",
) -> RunningTrajectory:
    """Start a trajectory from a state, as joint_trajectory_controller does.

    The segment before the first point begins now. Positions that the points do not give are integrated from their
    velocities, and velocities from accelerations, by the trapezoidal rule.

    Args:
        trajectory: The trajectory, without missing positions.
        time: The present simulation time (s).
        state: The state from which the joints begin; all joints' positions.
        wraparound: Whether each joint is continuous: it takes the short way to its first point.
        interpolation_method: One of `INTERPOLATION_METHODS`.
    """
    size = len(state.positions)
    start = time if trajectory.start is None else trajectory.start
    first = trajectory.points[0]
    zeros = (0.0,) * size
    before = replace(
        state,
        # Without them the first segment would be a spline of another degree than the others.
        velocities=state.velocities or (zeros if first.velocities else ()),
        accelerations=state.accelerations or (zeros if first.accelerations else ()),
    )
    turns = zeros
    if any(wraparound) and first.positions:
        near = tuple(
            goal - _shortest_turn(position, goal) if wraps else position
            for position, goal, wraps in zip(before.positions, first.positions, wraparound, strict=True)
        )
        turns = tuple(2.0 * pi * round((a - b) / (2.0 * pi)) for a, b in zip(before.positions, near, strict=True))
        before = replace(before, positions=near)
    taken_up = time - start
    firsts, lasts, begin = [], [], taken_up
    for point, end in zip(trajectory.points, trajectory.times, strict=True):
        first, last = _with_positions(before, point, size, max(end - begin, 0.0))
        firsts.append(first)
        lasts.append(last)
        before, begin = last, end
    return RunningTrajectory(
        start, trajectory.times, tuple(firsts), tuple(lasts), taken_up, interpolation_method, turns
    )


def interpolate(first: TrajectoryPoint, last: TrajectoryPoint, duration: float, elapsed: float) -> TrajectoryPoint:
    """Interpolate between two states with a spline.

    It is linear where only positions are given at both, cubic with velocities, quintic with accelerations too; efforts
    are interpolated linearly. (Positions with accelerations and without velocities are linear too, where upstream
    returns zeros.)

    Args:
        first: The state at its begin.
        last: The state at its end.
        duration: The time between the two (s), above zero.
        elapsed: The time since its begin (s).
    """
    T = duration
    s = min(max(elapsed / T, 0.0), 1.0)
    p0, p1 = np.array(first.positions), np.array(last.positions)
    delta = p1 - p0
    if not (first.velocities and last.velocities):
        coefficients = np.array([p0, delta])
    else:
        v0, v1 = T * np.array(first.velocities), T * np.array(last.velocities)
        if not (first.accelerations and last.accelerations):
            coefficients = np.array([p0, v0, 3.0 * delta - 2.0 * v0 - v1, v0 + v1 - 2.0 * delta])
        else:
            a0, a1 = T * T * np.array(first.accelerations), T * T * np.array(last.accelerations)
            coefficients = np.array(
                [
                    p0,
                    v0,
                    0.5 * a0,
                    10.0 * delta - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1,
                    -15.0 * delta + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1,
                    6.0 * delta - 3.0 * v0 - 3.0 * v1 - 0.5 * a0 + 0.5 * a1,
                ]
            )
    degree = np.arange(len(coefficients))
    slopes = degree[1:, np.newaxis] * coefficients[1:] / T
    curvatures = degree[1:-1, np.newaxis] * slopes[1:] / T
    powers = s**degree
    zeros = np.zeros(len(p0))
    e0, e1 = (np.array(point.effort) if point.effort else zeros for point in (first, last))
    return TrajectoryPoint(
        positions=tuple((powers @ coefficients).tolist()),
        velocities=tuple((powers[:-1] @ slopes).tolist()),
        accelerations=tuple((powers[:-2] @ curvatures).tolist()),
        effort=tuple((e0 + s * (e1 - e0)).tolist()),
    )


def position_error(desired: Sequence[float], actual: Sequence[float], wraparound: Sequence[bool]) -> tuple[float, ...]:
    """Return desired minus actual positions (rad or m); the short way around for joints that wrap around."""
    return tuple(
        _shortest_turn(q, q_d) if wraps else q_d - q for q_d, q, wraps in zip(desired, actual, wraparound, strict=True)
    )


def _shortest_turn(start: float, goal: float) -> float:
    """Return the angle from one to the other within ±π (rad); half a turn has the sign of goal minus start."""
    turn = (goal - start + pi) % (2.0 * pi) - pi
    if abs(abs(turn) - pi) < 1e-9:
        return pi if goal > start else -pi
    return turn


def _complete(point: TrajectoryPoint, size: int) -> TrajectoryPoint:
    zeros = (0.0,) * size
    if point.velocities and point.accelerations and point.effort:
        return point
    return TrajectoryPoint(
        point.positions or zeros, point.velocities or zeros, point.accelerations or zeros, point.effort or zeros
    )


def _with_positions(
    first: TrajectoryPoint, last: TrajectoryPoint, size: int, duration: float
) -> tuple[TrajectoryPoint, TrajectoryPoint]:
    """Return the two ends of a segment, with the last one's position integrated where it is not given."""
    if last.positions:
        return first, last
    zeros = (0.0,) * size
    first = replace(first, velocities=first.velocities or zeros)
    if not last.velocities:
        first = replace(first, accelerations=first.accelerations or zeros)
        last = replace(
            last, velocities=_integrated(first.velocities, first.accelerations, last.accelerations, duration)
        )
    return first, replace(last, positions=_integrated(first.positions, first.velocities, last.velocities, duration))


def _integrated(
    value: Sequence[float], first_slope: Sequence[float], last_slope: Sequence[float], duration: float
) -> tuple[float, ...]:
    return tuple(x + 0.5 * (a + b) * duration for x, a, b in zip(value, first_slope, last_slope, strict=True))
