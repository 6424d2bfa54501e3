"""The convex hull of a mesh, with few corners: Drake's hydroelastic contact takes 0.03 ms to prepare a corner."""

from itertools import pairwise

import numpy as np
from pydrake.geometry import PolygonSurfaceMesh

from drake_twin.dataclass import dataclass

_MOST_CORNERS = 64
_MANY_CORNERS = 10_000  # of which a hull is computed in a second
_DIRECTIONS = 4_000
_SLIVER = 1e-4
_SAME_PLANE = 1e-5  # an STL file's single precision turns slim triangles by some 1e-6
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
        RuntimeError: If the points have no hull: of SciPy (QhullError), or of Drake for a hull of 1e-10 m.
        ValueError: Likewise.
    """
    from scipy.spatial import ConvexHull

    corners = points[ConvexHull(points).vertices]
    if len(corners) > _MANY_CORNERS:
        corners = corners[_farthest(corners)]
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


def _farthest(corners: np.ndarray) -> np.ndarray:
    """Return the corners that reach farthest in some direction, which are 0.03 rad apart: a fine ball has very many."""
    index = np.arange(_DIRECTIONS) + 0.5  # on a Fibonacci spiral around the unit ball
    height, turn = 1 - 2 * index / _DIRECTIONS, np.pi * (1 + 5**0.5) * index
    radius = np.sqrt(1 - height**2)
    directions = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), height])
    directions = np.concatenate([directions, np.eye(3), -np.eye(3)])  # the box around it stays as it is
    return np.unique([int(np.argmax(corners @ direction)) for direction in directions])


def corners_of(hull: PolygonSurfaceMesh) -> np.ndarray:
    """Return the corners (n×3, m) of a hull of Drake's."""
    return np.array([hull.vertex(index) for index in range(hull.num_vertices())])


def planes_of(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the directions of a hull's sides (k×3), and their distances from the origin along these (k, m).

    Triangles that are in one plane but for the rounding of an STL file are one side.
    """
    from scipy.spatial import ConvexHull

    planes = np.unique(np.round(ConvexHull(corners).equations, 9), axis=0)
    near = np.append(np.full(3, _SAME_PLANE), _SAME_PLANE * np.ptp(corners, axis=0).max())
    different: list[np.ndarray] = []
    for plane in planes:
        if not any((np.abs(plane - other) < near).all() for other in different):
            different.append(plane)
    found = np.array(different)
    return found[:, :3], -found[:, 3]


@dataclass(frozen=True)
class Side:
    """A side of a hull on which it can stand.

    Attributes:
        area: m².
        width: Of a rectangle that resists tilting alike (m): √12 times the least radius of gyration of the area.
        height: Of the center of mass above it (m).
        off: Of the middle of its area from the foot of the center of mass (m).
        normal: Its direction outwards (3).
        middle: Of its area (3, m).
        corners: Around it (k×3, m).
        mean_distance: Of the points of its area from their middle (m).
    """

    area: float
    width: float
    height: float
    off: float
    normal: np.ndarray
    middle: np.ndarray
    corners: np.ndarray
    mean_distance: float


def sides_under(corners: np.ndarray, center: np.ndarray) -> list[Side]:
    """Return the sides of a hull (n×3, m) that are below its center of mass (m) when it stands on them."""
    normals, distances = planes_of(corners)
    near = _SAME_PLANE * float(np.ptp(corners, axis=0).max())
    found = []
    for normal, distance in zip(normals, distances, strict=True):
        height = float(distance - normal @ center)
        foot = center + height * normal
        if height <= 0 or (normals @ foot - distances).max() > near:
            continue
        around = corners[np.abs(corners @ normal - distance) < near]
        own = around - foot
        one = own[np.argmax(np.linalg.norm(own, axis=1))]
        one = (one - one @ normal * normal) / np.linalg.norm(one)
        axes = np.column_stack([one, np.cross(normal, one)])
        flat = own @ axes
        area, middle, moments = _moments_of_area(flat)
        if area > near**2:
            width = float(np.sqrt(12 * max(np.linalg.eigvalsh(moments / area)[0], 0.0)))
            off, place = float(np.linalg.norm(middle)), foot + axes @ middle
            found.append(Side(area, width, height, off, normal, place, around, mean_distance(flat - middle)))
    return found


def mean_distance(points: np.ndarray) -> float:
    """Return the mean distance from the origin (m) of the points of a convex polygon of the plane (n×2) around it."""
    around = _in_order(points)
    area = moment = 0.0
    for one, other in zip(around, np.roll(around, -1, axis=0), strict=True):
        edge = other - one
        length = float(np.hypot(*edge))
        double = abs(float(one[0] * other[1] - one[1] * other[0]))
        if length == 0.0 or double == 0.0:
            continue
        away = double / length  # of the edge
        t = np.array([one @ edge, other @ edge]) / (length * away)
        integral = t * np.sqrt(1 + t**2) + np.arcsinh(t)  # of the distance over the triangle, times 6 ÷ away³
        moment += away**3 / 6 * float(integral[1] - integral[0])
        area += double / 2
    return moment / area if area > 0 else 0.0


def _in_order(points: np.ndarray) -> np.ndarray:
    """Return the corners of a convex polygon of the plane (n×2) in the order around it."""
    around = points - points.mean(axis=0)
    return points[np.argsort(np.arctan2(around[:, 1], around[:, 0]), kind="stable")]


def _moments_of_area(points: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Return area, middle and second moments about the middle (2×2) of a convex polygon of the plane (n×2)."""
    around = _in_order(points) - points.mean(axis=0)
    area, first, second = 0.0, np.zeros(2), np.zeros((2, 2))
    for one, other in zip(around, np.roll(around, -1, axis=0), strict=True):  # triangles from the corners' mean
        part = abs(float(one[0] * other[1] - one[1] * other[0])) / 2
        area += part
        first += part * (one + other) / 3
        total = one + other
        second += part / 12 * (np.outer(one, one) + np.outer(other, other) + np.outer(total, total))
    middle = first / area if area > 0 else first
    return area, middle + points.mean(axis=0), second - area * np.outer(middle, middle)


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
