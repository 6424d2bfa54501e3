"""The times of a path: as fast as the joints' velocities and accelerations allow (Drake's TOPPRA)."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from pydrake.multibody.optimization import CalcGridPointsOptions, Toppra
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import PrismaticJoint, SpatialInertia
from pydrake.trajectories import PathParameterizedTrajectory, PiecewisePolynomial

from drake_twin.dataclass import dataclass

_SAMPLE = 0.1  # s between two points, as MoveIt's time parameterization has them
_CLOSE = 1e-6  # rad or m, below which two points of a path are one


@dataclass(frozen=True)
class TimedPoint:
    """A point of a trajectory: time (s), positions (rad or m), velocities and accelerations, each shape (n,)."""

    time: float
    positions: np.ndarray
    velocities: np.ndarray
    accelerations: np.ndarray


def timed(path: Sequence[np.ndarray], velocities: np.ndarray, accelerations: np.ndarray) -> list[TimedPoint]:
    """Return a path's points with their times, from rest to rest.

    Args:
        path: Positions (rad or m), each shape (n,).
        velocities: The joints' largest velocities (rad/s or m/s), shape (n,).
        accelerations: Their largest accelerations (rad/s² or m/s²), shape (n,).
    """
    points = [path[0]]
    for point in path[1:]:
        if np.abs(point - points[-1]).max() > _CLOSE:
            points.append(point)
    zero = np.zeros(path[0].size)
    if len(points) < 2:
        return [TimedPoint(0.0, path[0], zero, zero)]
    if len(points) == 2:
        points.insert(1, 0.5 * (points[0] + points[1]))  # for a curve through them
    lengths = [0.0, *np.cumsum([np.abs(b - a).max() for a, b in pairwise(points)])]
    curve = PiecewisePolynomial.CubicShapePreserving(np.array(lengths), np.array(points).T)
    grid = Toppra.CalcGridPoints(curve, CalcGridPointsOptions())
    toppra = Toppra(curve, _axes(zero.size), grid)
    toppra.AddJointVelocityLimit(-velocities, velocities)
    toppra.AddJointAccelerationLimit(-accelerations, accelerations)
    times = toppra.SolvePathParameterization()
    if times is None:
        raise ValueError("the path has no times within the joints' velocities and accelerations")
    motion = PathParameterizedTrajectory(curve, times)
    end = motion.end_time()
    found = []
    for time in [*np.arange(0.0, end - 1e-3, _SAMPLE), end]:
        rates = [motion.EvalDerivative(time, order).ravel() for order in (1, 2)]
        found.append(TimedPoint(float(time), motion.value(time).ravel(), *rates))
    near = min(1e-3, 0.5 * end)  # at the ends themselves the path's speed has no derivative
    starts, stops = (motion.EvalDerivative(time, 2).ravel() for time in (near, end - near))
    found[0], found[-1] = TimedPoint(0.0, points[0], zero, starts), TimedPoint(float(end), points[-1], zero, stops)
    return found


def _axes(count: int) -> MultibodyPlant:
    """Return a plant with so many independent joints, for TOPPRA counts them."""
    plant = MultibodyPlant(0.0)
    for number in range(count):
        body = plant.AddRigidBody(f"body {number}", SpatialInertia.SolidSphereWithMass(1.0, 0.1))
        joint = PrismaticJoint(f"joint {number}", plant.world_frame(), body.body_frame(), [1.0, 0.0, 0.0])
        plant.AddJoint(joint)
    plant.Finalize()
    return plant
