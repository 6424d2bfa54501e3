"""The convex hull of a mesh, with few corners: Drake's hydroelastic contact takes 0.03 ms to prepare a corner."""

from itertools import pairwise

import numpy as np
from pydrake.geometry import PolygonSurfaceMesh

_MOST_CORNERS = 64
_SLIVER = 1e-4
_LOSS = 1e-3  # what a hull may lose, as a part of its size, to have fewer corners


def hull_of(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute a hull of points.

    Its corners are those that reach farthest beyond the others, so that flat faces stay flat; a round mesh with more
    corners loses some hundredths of its size.

    Args:
        points: N×3 (m).

    Returns:
        The corners (m×3) and the triangles between them (k×3, indices).

    Raises:
        scipy.spatial.QhullError: If the points have no hull.
        ValueError: Likewise.
    """
    from scipy.spatial import ConvexHull

    corners = points[ConvexHull(points).vertices]
    box = (*corners.argmin(axis=0).tolist(), *corners.argmax(axis=0).tolist())  # the box around it stays as it is
    kept = list(dict.fromkeys((*box, *_far_apart(corners))))
    while True:
        hull = ConvexHull(corners[kept])
        beyond = (corners @ hull.equations[:, :3].T + hull.equations[:, 3]).max(axis=1)
        farthest = int(np.argmax(beyond))
        enough = beyond[farthest] <= _LOSS * float(np.ptp(corners, axis=0).max()) or len(kept) >= _MOST_CORNERS
        if enough or farthest in kept:
            coarse = without_slivers(corners[kept][hull.vertices])
            return coarse, np.asarray(ConvexHull(coarse).simplices)
        kept.append(farthest)


def corners_of(hull: PolygonSurfaceMesh) -> np.ndarray:
    """Return the corners (n×3, m) of a hull of Drake's."""
    return np.array([hull.vertex(index) for index in range(hull.num_vertices())])


def planes_of(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the directions of a hull's sides (k×3), and their distances from the origin along these (k, m)."""
    from scipy.spatial import ConvexHull

    planes = np.unique(np.round(ConvexHull(corners).equations, 9), axis=0)
    return planes[:, :3], -planes[:, 3]


def without_slivers(corners: np.ndarray, least: float | None = None) -> np.ndarray:
    """Remove corners of a hull that make triangles of hardly any area, at which Drake's contact fails.

    Args:
        corners: N×3 (m).
        least: Twice the least area of a triangle (m²); by default a ten-thousandth of the hull's size squared.
    """
    if least is None:
        least = _SLIVER * float(np.ptp(corners, axis=0).max()) ** 2
    while True:
        triangles = _triangles(corners)
        edges = np.roll(triangles, -1, axis=1) - triangles
        areas = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
        worst = int(np.argmin(areas))
        if areas[worst] >= least or len(corners) <= 4:
            return corners
        # The corner opposite to the longest edge is almost on it; the middle of the hull is not a corner.
        order = np.argsort(np.linalg.norm(edges[worst], axis=1))[::-1]
        apart = (np.linalg.norm(corners - triangles[worst, (int(edge) + 2) % 3], axis=1) for edge in order)
        corners = corners[next(distances for distances in apart if distances.min() == 0) > 0]


def _triangles(corners: np.ndarray) -> np.ndarray:
    """Return the triangles (m×3×3) into which Drake divides the sides of a hull, and those from the middle to their
    edges.
    """
    from pydrake.geometry import Convex

    hull = Convex(np.ascontiguousarray(corners.T), "hull").GetConvexHull()
    points = corners_of(hull)
    middle = points.mean(axis=0)
    found = []
    for index in range(hull.num_elements()):
        side = hull.element(index)
        around = [points[side.vertex(k)] for k in range(side.num_vertices())]
        for one, other in pairwise(around[1:]):
            found += [(around[0], one, other), (middle, one, other), (middle, around[0], one)]
        found.append((middle, around[0], around[-1]))
    return np.array(found)


def _far_apart(corners: np.ndarray) -> list[int]:
    """Return four corners that are not in one plane."""
    first = int(np.argmax(np.linalg.norm(corners - corners.mean(axis=0), axis=1)))
    kept = [first]
    for _ in range(3):
        _, sizes, directions = np.linalg.svd(corners[kept] - corners[first])
        known = directions[: int((sizes > 1e-9 * max(sizes[0], 1e-300)).sum())]
        apart = corners - corners[first]
        kept.append(int(np.argmax(np.linalg.norm(apart - apart @ known.T @ known, axis=1))))
    return kept
