"""Where rays meet spheres, ellipsoids, cylinders and capsules: the quadratic formula, in double precision.

Many rays and shapes of one kind are calculated at once, as pairs of a ray and a shape; each pair's numbers are its own.
"""

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


def sizes_of(shape: Shape) -> tuple[float, float, float]:
    """Return what `distances` takes of a round shape: its half axes; radius, radius and half of a cylinder's length."""
    if isinstance(shape, Ellipsoid):
        return shape.a(), shape.b(), shape.c()
    radius = shape.radius()
    return radius, radius, radius if isinstance(shape, Sphere) else shape.length() / 2


def distances(
    kind: type[Shape],
    sizes: np.ndarray,
    origins: np.ndarray,
    directions: np.ndarray,
    nearest: float,
    *,
    from_inside: bool = True,
) -> np.ndarray:
    """Return how far away rays meet round shapes (m); infinite where they do not.

    Args:
        kind: The shapes' class.
        sizes: The result of `sizes_of` of each shape, (pairs, 3).
        origins: Where each ray begins, in its shape's frame, (pairs, 3).
        directions: Unit vectors in the shapes' frames, (pairs, 3).
        nearest: What is nearer is not seen (m).
        from_inside: Whether a shape is met from inside, too.
    """
    first = _first if from_inside else _entry
    with np.errstate(divide="ignore", invalid="ignore"):
        if kind in (Sphere, Ellipsoid):
            return first(_quadric(origins / sizes, directions / sizes), nearest)
        radius, half = sizes[:, :1], sizes[:, 2]
        side = _quadric(origins[:, :2] / radius, directions[:, :2] / radius)
        side[np.abs(origins[:, 2] + side * directions[:, 2]) > half] = np.inf
        ends = _balls if kind is Capsule else _discs
        return first(
            np.vstack([side, *(ends(radius, half, sign, origins, directions) for sign in (1.0, -1.0))]), nearest
        )


def _discs(
    radius: np.ndarray, half: np.ndarray, sign: float, origins: np.ndarray, directions: np.ndarray
) -> np.ndarray:
    """Return the distances to the upper or lower ends of cylinders."""
    found: np.ndarray = (sign * half - origins[:, 2]) / directions[:, 2]
    across = origins[:, :2] + found[:, np.newaxis] * directions[:, :2]
    found[~(np.einsum("ij,ij->i", across, across) <= radius[:, 0] ** 2)] = np.inf
    return found[np.newaxis]


def _balls(
    radius: np.ndarray, half: np.ndarray, sign: float, origins: np.ndarray, directions: np.ndarray
) -> np.ndarray:
    """Return the distances to the upper or lower half balls of capsules."""
    start = origins.copy()
    start[:, 2] -= sign * half
    found = _quadric(start / radius, directions / radius)
    found[sign * (origins[:, 2] + found * directions[:, 2]) < half] = np.inf
    return found


def _quadric(starts: np.ndarray, ways: np.ndarray) -> np.ndarray:
    """Return both distances at which ``|start + t way| = 1``, one a row; infinite or NaN for a ray that misses."""
    a = np.einsum("ij,ij->i", ways, ways)
    b = np.einsum("ij,ij->i", ways, starts)
    c = np.einsum("ij,ij->i", starts, starts) - 1.0
    root = np.sqrt(b**2 - a * c)
    # The sum that cancels is avoided: the other root follows from the product of both.
    larger = -b - np.copysign(root, b)
    return np.vstack([larger / a, c / larger])


def _first(candidates: np.ndarray, nearest: float) -> np.ndarray:
    return np.asarray(np.where(candidates >= nearest, candidates, np.inf).min(axis=0))


def _entry(candidates: np.ndarray, nearest: float) -> np.ndarray:
    entry = np.where(np.isnan(candidates), np.inf, candidates).min(axis=0)
    return np.asarray(np.where(entry >= nearest, entry, np.inf))
