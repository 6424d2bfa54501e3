"""The shapes with yielding faces, as meshes that are fine enough to stand and slide.

Drake applies one force at the middle of each facet where two shapes meet. On a face of two triangles a body rocks about
the line between the two forces and never comes to rest. With fewer facets it creeps more, because the solver's
regularization of friction is divided among them.
"""

from collections.abc import Sequence
from functools import lru_cache
from heapq import heappop, heappush
from itertools import pairwise

import numpy as np
from pydrake.common import MemoryFile
from pydrake.geometry import Box, Convex, InMemoryMesh, Mesh, Shape

from drake_twin.description.hull import corners_of, without_slivers
from drake_twin.diagram.contact_shapes import ContactShape

_SQUARES = 4  # along a side of a box
_LONGEST = 0.6  # edge of a hull's triangles, relative to the hull's size
_LEAST_AREA = 1e-9  # m²; at a tenth of that, Drake reports that it cannot make a plane

Triangle = tuple[int, int, int]


def yielding(shape: ContactShape) -> Shape:
    """Return the shape whose faces yield: a hull or a box becomes a fine mesh of itself."""
    if isinstance(shape.shape, Convex):
        source, scale = shape.shape.source(), tuple(shape.shape.scale3().tolist())
        text = _hull_of_file(str(source.path()), scale) if source.is_path() else _fine_hull(shape.shape)
        if text is None:
            return shape.shape
    elif shape.is_loose and isinstance(shape.shape, Box):
        text = _fine_box(*shape.shape.size().tolist())
    else:
        return shape.shape
    return Mesh(InMemoryMesh(mesh_file=MemoryFile(text, ".vtk", "yielding shape")))


@lru_cache(maxsize=1024)
def _hull_of_file(path: str, scale: tuple[float, ...]) -> str | None:
    return _fine_hull(Convex(path, np.array(scale)))


def _fine_hull(shape: Convex) -> str | None:
    """Return a hull as VTK text, without slivers, which would end the simulation on contact.

    Returns:
        None for a hull that is fine enough as it is.
    """
    hull = shape.GetConvexHull()
    corners = without_slivers(corners_of(hull), _LEAST_AREA)
    is_whole = len(corners) == hull.num_vertices()
    if not is_whole:
        hull = Convex(np.ascontiguousarray(corners.T), "hull").GetConvexHull()
    points = corners_of(hull)
    triangles: list[Triangle] = []
    for index in range(hull.num_elements()):
        side = hull.element(index)
        first, *others = (side.vertex(k) for k in range(side.num_vertices()))
        triangles += [(first, one, other) for one, other in pairwise(others)]
    fine, triangles = _refined(points, triangles, _LONGEST * float(np.ptp(points, axis=0).max()))
    if is_whole and len(fine) == len(points):
        return None
    return _vtk(fine, triangles, points.mean(axis=0))


def _refined(points: np.ndarray, triangles: list[Triangle], longest: float) -> tuple[np.ndarray, list[Triangle]]:
    """Return a surface (n×3, m) whose longest edges are halved until all are shorter than ``longest`` (m)."""
    places = [np.asarray(point) for point in points]
    known = dict(enumerate(triangles))
    beside: dict[tuple[int, int], int] = {}  # an edge in the order of its triangle → that triangle
    edges: list[tuple[float, int, int]] = []

    def add(number: int, triangle: Triangle) -> None:
        known[number] = triangle
        for a, b in pairwise((*triangle, triangle[0])):
            beside[a, b] = number
            length = float(np.linalg.norm(places[a] - places[b]))
            if a < b and length > longest:
                heappush(edges, (-length, a, b))

    for number, triangle in enumerate(triangles):
        add(number, triangle)
    while edges:
        _, a, b = heappop(edges)
        if (a, b) not in beside or (b, a) not in beside:
            continue
        if any(_double_area(places, known[beside[edge]]) < 2 * _LEAST_AREA for edge in ((a, b), (b, a))):
            continue
        places.append((places[a] + places[b]) / 2)
        middle = len(places) - 1
        for one, other in ((a, b), (b, a)):
            number = beside.pop((one, other))
            corner = next(index for index in known[number] if index not in (one, other))
            add(number, (one, middle, corner))
            add(len(known), (middle, other, corner))
    return np.array(places), list(known.values())


def _double_area(places: Sequence[np.ndarray], triangle: Triangle) -> float:
    a, b, c = (places[index] for index in triangle)
    return float(np.linalg.norm(np.cross(b - a, c - a)))


@lru_cache(maxsize=64)
def _fine_box(x: float, y: float, z: float) -> str:
    """Return a box with squares on its sides, as VTK text."""
    points: dict[tuple[float, ...], int] = {}
    triangles: list[Triangle] = []
    cuts = np.linspace(-0.5, 0.5, _SQUARES + 1).tolist()
    for axis in range(3):
        for side in (-0.5, 0.5):
            for i, (left, right) in enumerate(pairwise(cuts)):
                for j, (low, high) in enumerate(pairwise(cuts)):
                    corners = []
                    for across in ((left, low), (right, low), (right, high), (left, high)):
                        point = np.roll((side, *across), axis) * (x, y, z)
                        corners.append(points.setdefault(tuple(point.tolist()), len(points)))
                    a, b, c, d = corners if side > 0 else corners[::-1]  # counterclockwise, seen from outside
                    triangles += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(b, c, d), (b, d, a)]
    return _vtk(np.array(list(points)), triangles, np.zeros(3))


def _vtk(points: np.ndarray, triangles: list[Triangle], center: np.ndarray) -> str:
    """Return the tetrahedra between an inner point and the triangles of a surface, counterclockwise from outside."""
    lines = ["# vtk DataFile Version 3.0", "yielding shape", "ASCII", "DATASET UNSTRUCTURED_GRID"]
    lines += [
        f"POINTS {len(points) + 1} double",
        *(" ".join(map(repr, row)) for row in [*points.tolist(), center.tolist()]),
    ]
    lines += [
        f"CELLS {len(triangles)} {5 * len(triangles)}",
        *(f"4 {a} {c} {b} {len(points)}" for a, b, c in triangles),
    ]
    return "\n".join([*lines, f"CELL_TYPES {len(triangles)}", *["10"] * len(triangles), ""])
