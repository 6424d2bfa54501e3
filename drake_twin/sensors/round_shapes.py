"""Where rays meet spheres, ellipsoids, cylinders and capsules: the quadratic formula, in double precision."""

import numpy as np
from pydrake.geometry import Capsule, Cylinder, Ellipsoid, Shape, Sphere

ROUND_SHAPES = (Sphere, Ellipsoid, Cylinder, Capsule)


def radius_of(shape: Shape) -> float:
    """Return the radius of a sphere about a round shape's center (m)."""
    if isinstance(shape, Ellipsoid):
        return float(max(shape.a(), shape.b(), shape.c()))
    if isinstance(shape, Cylinder):
        return float(np.hypot(shape.radius(), shape.length() / 2))
    return float(shape.radius() + (shape.length() / 2 if isinstance(shape, Capsule) else 0.0))


def distances(shape: Shape, origin: np.ndarray, directions: np.ndarray, nearest: float) -> np.ndarray:
    """Return how far away rays meet a round shape from outside or inside (m); infinite where they do not.

    Args:
        shape: A sphere, ellipsoid, cylinder or capsule.
        origin: Where the rays begin, in the shape's frame.
        directions: Unit vectors, one a row.
        nearest: What is nearer is not seen (m).
    """
    if isinstance(shape, Sphere):
        return _first(_quadric(origin, directions, np.full(3, 1 / shape.radius())), nearest)
    if isinstance(shape, Ellipsoid):
        return _first(_quadric(origin, directions, 1 / np.array([shape.a(), shape.b(), shape.c()])), nearest)
    half = shape.length() / 2
    side = _quadric(origin, directions, np.array([1.0, 1.0, 0.0]) / shape.radius())
    side[np.abs(origin[2] + side * directions[:, 2]) > half] = np.inf
    return _first(np.vstack([side, *_ends(shape, origin, directions, half)]), nearest)


def _ends(shape: Shape, origin: np.ndarray, directions: np.ndarray, half: float) -> list[np.ndarray]:
    """Return the distances to the two ends: discs of a cylinder, half spheres of a capsule."""
    found = []
    for end in (half, -half):
        if isinstance(shape, Capsule):
            ball = _quadric(origin - [0.0, 0.0, end], directions, np.full(3, 1 / shape.radius()))
            ball[(origin[2] + ball * directions[:, 2]) * np.sign(end) < half] = np.inf
            found.append(ball)
        else:
            disc = (end - origin[2]) / directions[:, 2]
            across = origin[:2] + disc[:, np.newaxis] * directions[:, :2]
            disc[~(np.einsum("ij,ij->i", across, across) <= shape.radius() ** 2)] = np.inf
            found.append(disc[np.newaxis])
    return found


def _quadric(origin: np.ndarray, directions: np.ndarray, scales: np.ndarray) -> np.ndarray:
    """Return both distances at which ``|scales · p| = 1``, one a row; infinite or NaN for a ray that misses."""
    start, way = origin * scales, directions * scales
    a = np.einsum("ij,ij->i", way, way)
    b = way @ start
    c = start @ start - 1.0
    root = np.sqrt(b**2 - a * c)
    # The sum that cancels is avoided: the other root follows from the product of both.
    larger = -b - np.copysign(root, b)
    return np.vstack([larger / a, c / larger])


def _first(candidates: np.ndarray, nearest: float) -> np.ndarray:
    candidates = np.atleast_2d(candidates)
    return np.asarray(np.where(candidates >= nearest, candidates, np.inf).min(axis=0))
