"""Trajectories that bring joints to rest."""

from collections.abc import Sequence

from drake_twin.control.trajectory import Trajectory, TrajectoryPoint

_FLOAT32_EPSILON = 2.0**-23


def hold_trajectory(positions: Sequence[float]) -> Trajectory:
    """Return a trajectory that rests at positions.

    Args:
        positions: Of the joints (rad or m).
    """
    zeros = (0.0,) * len(positions)
    return Trajectory((TrajectoryPoint(tuple(positions), zeros, zeros, zeros),), (0.0,))


def stop_trajectory(
    positions: Sequence[float], velocities: Sequence[float], decelerations: Sequence[float]
) -> Trajectory:
    """Return a trajectory that brings each joint to rest with its constant deceleration, and holds it there.

    Its cubic splines are the parabolas of that motion.

    Args:
        positions: Of the joints (rad or m).
        velocities: Of the joints (rad/s or m/s).
        decelerations: Of the joints (rad/s² or m/s²), above zero.
    """
    durations = [
        abs(v) / a if abs(v) > _FLOAT32_EPSILON else 0.0 for v, a in zip(velocities, decelerations, strict=True)
    ]
    times = tuple(sorted({0.0, *durations}))
    points = []
    for time in times:
        moved, slowed = [], []
        for q, v, duration in zip(positions, velocities, durations, strict=True):
            t = min(time, duration)
            left = 1.0 - t / duration if duration > 0.0 else 0.0
            slowed.append(v * left)
            moved.append(q + 0.5 * v * (1.0 + left) * t)
        points.append(TrajectoryPoint(tuple(moved), tuple(slowed)))
    return Trajectory(tuple(points), times)
