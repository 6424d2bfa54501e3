"""The shapes with yielding faces, as meshes that are fine enough to stand and slide.

Drake applies one force at the middle of each facet where two shapes meet. On a face of two triangles a body rocks about
the line between the two forces and never comes to rest. With fewer facets it creeps more, because the solver's
regularization of friction is divided among them.

The pressure in a mesh rises from its surface to its inner points. With one inner point it would rise ever more slowly
behind the sides that are farther from it, so that things fall over on their ends: loose ones have a core, as deep
behind each side.

The sides of what has a core are hollow by a hair (`_HOLLOW`), for the discrete solver's sake. A facet in the margin has
a negative pressure, and Drake's cost a constant for it that grows with the square of 1 ÷ the pressure's gradient along
the ground's normal. Behind a side that stands across the ground the gradient is nothing but rounding, and the constant
1e15 J and more. Beside it the other terms are lost: the solver stops after an iteration, and what falls onto its corner
flies up. Behind the lower part of a hollow side the pressure falls towards the ground: Drake leaves such facets out.
"""

from collections.abc import Sequence
from functools import lru_cache
from heapq import heappop, heappush
from itertools import pairwise, product
from math import sqrt

import numpy as np
from pydrake.common import MemoryFile
from pydrake.geometry import Box, Convex, Cylinder, InMemoryMesh, Mesh, Shape

from drake_twin.dataclass import dataclass
from drake_twin.description.hull import corners_of, planes_of, without_slivers
from drake_twin.description.mesh_triangles import hull_name
from drake_twin.diagram.contact_shapes import ContactShape
from drake_twin.diagram.tetrahedra import Polygon, is_closed, tetrahedra_of, vtk_text
from drake_twin.diagram.track_shapes import soft_box

_NAME, _HARD_NAME = "yielding shape", "hard shape"
_SQUARES = 3  # along the sides of a box
_MORE_SQUARES = 4
_LONGEST = 0.6  # edge of a hull's triangles, relative to the hull's size
_LONGEST_OF_TRACK = 0.2  # ``track_shapes`` says why

# Edge of the triangles of what does not yield, relative to the middle of its three sides, and to the longest one at
# least. With whole sides, Panda's pads, on a cube of 80 mm between facets of 27 mm, let it slip by three times as much.
_LONGEST_HARD = 0.6
_SHORTEST_HARD = 1 / 16

_LEAST_AREA = 1e-9  # m²; at a tenth of that, Drake reports that it cannot make a plane

# Where the pressure in a loose box or hull stops to rise, below each of its sides: relative to the distance of the
# nearest side from the middle. Hulls try the next one where the parts behind their sides do not fit each other.
_CORE = 0.5
_CORES = (_CORE, 0.2, 0.05)
_HOLLOW = 1e-4  # the middles of the sides, relative to their distance from the body's middle
_MOST_HOLLOW = 1e-5  # of a corner's distance (m): what is heavy sinks in by 25 µm
_MOST_OF_DEPTH = 0.05  # the same, of the core's depth
_DIGITS = 12  # decimals of a place (m): the last bits of what is solved differ between SciPy's versions
_MOST_SIDES = 64  # of a hull with a core; more take a second to prepare, and belong to round things

Triangle = tuple[int, int, int]


@dataclass(frozen=True)
class Yielding:
    """A shape whose faces yield.

    Attributes:
        shape: The shape: of a hull and of a loose box a fine mesh.
        depth: How deep the pressure rises behind each of its sides (m); None where it rises to the middle of a hull.
    """

    shape: Shape
    depth: float | None

    @property
    def is_hollow(self) -> bool:
        """Whether its sides are, so that a margin does no harm in engines with fixed steps."""
        return self.depth is not None and isinstance(self.shape, Mesh)


def yielding(shape: ContactShape) -> Yielding:
    """Return a shape as one whose faces yield: a hull or a box becomes a fine mesh of itself."""
    form, longest = shape.shape, _LONGEST_OF_TRACK if shape.is_track else _LONGEST
    if shape.is_track and isinstance(form, Box):
        return Yielding(_mesh(soft_box(*form.size().tolist())), None)
    if isinstance(form, Convex):
        source, scale, name = form.source(), tuple(form.scale3().tolist()), _NAME
        if source.is_path():
            text, depth = _hull_of_file(str(source.path()), scale, shape.is_loose, longest)
            name = hull_name(source.path(), scale)
        else:
            text, depth = _fine_hull(form, shape.is_loose, longest)
        return Yielding(form if text is None else _mesh(text, name), depth)
    if not isinstance(form, Box):
        return Yielding(form, min(form.radius(), form.length() / 2) if isinstance(form, Cylinder) else None)
    middle = float(min(form.size())) / 2
    if not shape.is_loose:
        return Yielding(form, middle)
    return Yielding(_mesh(_fine_box(*form.size().tolist())), _CORE * middle)


def hard(shape: ContactShape, *, is_fine: bool) -> Shape:
    """Return a shape that does not yield; if ``is_fine`` in fine triangles, as pads are smaller than a crate."""
    form = shape.shape
    if isinstance(form, Box) and is_fine:
        return _mesh(_hard_surface(*_box_surface(form.size()), is_fine), _HARD_NAME, ".obj")
    if not isinstance(form, Convex):
        return form
    source, scale = form.source(), tuple(form.scale3().tolist())
    if source.is_path():
        return _mesh(_hard_surface_of_file(str(source.path()), scale, is_fine), hull_name(source.path(), scale), ".obj")
    return _mesh(_hard_surface(*_surface(form)[:2], is_fine), _HARD_NAME, ".obj")


def _mesh(text: str, name: str = _NAME, extension: str = ".vtk") -> Mesh:
    return Mesh(InMemoryMesh(mesh_file=MemoryFile(text, extension, name)))


@lru_cache(maxsize=1024)
def _hull_of_file(
    path: str, scale: tuple[float, ...], is_loose: bool, longest: float
) -> tuple[str | None, float | None]:
    return _fine_hull(Convex(path, np.array(scale)), is_loose, longest)


def _fine_hull(shape: Convex, is_loose: bool, longest: float = _LONGEST) -> tuple[str | None, float | None]:
    """Return a hull as VTK text, without slivers, which would end the simulation on contact.

    A loose one has a core, so that the pressure rises alike behind each of its sides.

    Returns:
        The text, or None for a hull that is fine enough as it is; how deep its core is (m), or None if it has none.
    """
    points, triangles, is_whole = _surface(shape)
    fine, triangles = _refined(points, triangles, longest * float(np.ptp(points, axis=0).max()))
    if is_loose and (cored := _with_core(points, fine, triangles)) is not None:
        return cored
    if is_whole and len(fine) == len(points):
        return None, None
    inner = np.vstack([fine, points.mean(axis=0)])
    return vtk_text(inner, [(a, c, b, len(fine)) for a, b, c in triangles]), None


def _surface(shape: Convex) -> tuple[np.ndarray, list[Triangle], bool]:
    """Return the corners (n×3, m) and triangles of a hull without slivers, and whether it had none."""
    hull = shape.GetConvexHull()
    corners = without_slivers(corners_of(hull), _LEAST_AREA)
    is_whole = len(corners) == hull.num_vertices()
    if not is_whole:
        hull = Convex(np.ascontiguousarray(corners.T), "hull").GetConvexHull()
    triangles: list[Triangle] = []
    for index in range(hull.num_elements()):
        side = hull.element(index)
        first, *others = (side.vertex(k) for k in range(side.num_vertices()))
        triangles += [(first, one, other) for one, other in pairwise(others)]
    return corners_of(hull), triangles, is_whole


@lru_cache(maxsize=1024)
def _hard_surface_of_file(path: str, scale: tuple[float, ...], is_fine: bool) -> str:
    return _hard_surface(*_surface(Convex(path, np.array(scale)))[:2], is_fine)


def _box_surface(size: np.ndarray) -> tuple[np.ndarray, list[Triangle]]:
    """Return the corners (8×3, m) and triangles of a box."""
    corners = {signs: number for number, signs in enumerate(product((-1, 1), repeat=3))}
    triangles: list[Triangle] = []
    for axis, side in product(range(3), (-1, 1)):
        a, b, c, d = _around(corners, axis, side)[::side]
        triangles += [(a, b, c), (a, c, d)]
    return 0.5 * np.array(list(corners)) * size, triangles


def _hard_surface(points: np.ndarray, triangles: list[Triangle], is_fine: bool) -> str:
    """Return a surface (n×3, m) as OBJ text, with fine triangles if asked for."""
    _, middle, largest = sorted(np.ptp(points, axis=0).tolist())
    if is_fine:
        points, triangles = _refined(points, triangles, max(_LONGEST_HARD * middle, _SHORTEST_HARD * largest))
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
    return "\n".join([*lines, *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles)])


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
            between = places[a] - places[b]
            length = sqrt(between.dot(between))
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


def _hollow(surface: np.ndarray, depth: float) -> np.ndarray:
    """Return the points of a surface around the origin (n×3, m), whose sides become hollow; the farthest stay.

    They are far from reaching a core at a depth (m).
    """
    squares = (surface**2).sum(axis=1)
    share = min(_HOLLOW, min(_MOST_HOLLOW, _MOST_OF_DEPTH * depth) / float(squares.max()) ** 0.5)
    farther = 1 - share * (1 - squares / squares.max())
    return np.asarray(np.round(surface * farther[:, None], _DIGITS))


def _double_area(places: Sequence[np.ndarray], triangle: Triangle) -> float:
    a, b, c = (places[index] for index in triangle)
    (x, y, z), (u, v, w) = (b - a).tolist(), (c - a).tolist()
    return sqrt((y * w - z * v) ** 2 + (z * u - x * w) ** 2 + (x * v - y * u) ** 2)


def _with_core(corners: np.ndarray, surface: np.ndarray, triangles: Sequence[Triangle]) -> tuple[str, float] | None:
    """Return a hull with a core as VTK text, and how deep the core is (m); None for round ones, or if that fails."""
    middle = corners.mean(axis=0)
    normals, distances = planes_of(corners - middle)
    if len(normals) > _MOST_SIDES:
        return None
    for share in _CORES:
        depth = share * float(distances.min())
        cells = _cells(normals, distances, depth, surface - middle, triangles)
        if cells is not None and is_closed(tetrahedra := tetrahedra_of(*cells), len(triangles)):
            inside = cells[0][: -len(surface)]
            return vtk_text(np.vstack([inside, _hollow(surface - middle, depth)]) + middle, tetrahedra), depth
    return None


def _cells(
    normals: np.ndarray, distances: np.ndarray, depth: float, outside: np.ndarray, triangles: Sequence[Triangle]
) -> tuple[np.ndarray, list[list[Polygon]]] | None:
    """Divide a hull into a core at one depth and, behind each side, the part that is nearest to that side.

    Args:
        normals: The directions of its sides (k×3).
        distances: Their distances from the origin, which is inside (k, m).
        depth: The depth of the core (m).
        outside: The points of its surface (m×3, m).
        triangles: The triangles between these.

    Returns:
        Points and the polygons around each cell; None where that fails, as in hulls with tiny sides.
    """
    from scipy.spatial import HalfspaceIntersection, QhullError

    near = 1e-6 * float(np.ptp(outside, axis=0).max())
    inside: list[np.ndarray] = []
    numbers: list[list[int]] = []  # of each side's inner points
    for normal, distance in zip(normals, distances, strict=True):
        others = np.column_stack([normals - normal, distance - distances])
        keep = np.abs(others[:, :3]).max(axis=1) > 1e-9
        bounds = np.vstack([others[keep], [*normal, -distance], [*-normal, distance - depth]])
        foot = outside[np.abs(outside @ normal - distance) < near].mean(axis=0)
        start = next(
            (
                p
                for p in (foot - share * depth * normal for share in (0.3, 0.03, 0.003))
                if (bounds[:, :3] @ p + bounds[:, 3]).max() < -1e-3 * near
            ),
            None,
        )
        if start is None:
            return None
        try:
            found = HalfspaceIntersection(bounds, start).intersections
        except QhullError:
            return None
        own: set[int] = set()
        for point in found[np.isfinite(found).all(axis=1) & (distance - found @ normal > near)]:
            known = next((k for k, other in enumerate(inside) if np.abs(other - point).max() < near), len(inside))
            if known == len(inside):
                inside.append(point)
            own.add(known)
        numbers.append(sorted(own))
    points = np.vstack([np.round(inside, _DIGITS), outside])
    first = len(inside)
    depths = distances - points @ normals.T  # of each point below each side
    cells: list[list[Polygon]] = [[]]
    for side, inner in enumerate(numbers):
        on_side = [index for index in range(first, len(points)) if abs(depths[index, side]) < near]
        of_side = set(on_side)
        polygons: list[Polygon] = [
            (a + first, b + first, c + first) for a, b, c in triangles if {a + first, b + first, c + first} <= of_side
        ]
        top = _in_order(points, [index for index in inner if abs(depths[index, side] - depth) < near])
        if top:
            polygons.append(top)
            cells[0].append(top)
        for other in range(len(numbers)):
            wall = [index for index in [*inner, *on_side] if abs(depths[index, side] - depths[index, other]) < near]
            if other != side and (polygon := _in_order(points, wall)):
                polygons.append(polygon)
        cells.append(polygons)
    return points, cells


def _in_order(points: np.ndarray, indices: Sequence[int]) -> Polygon:
    """Return the points of a convex polygon in the order around it; none where they are on one line."""
    if len(indices) < 3:
        return ()
    own = points[list(indices)] - points[list(indices)].mean(axis=0)
    _, sizes, axes = np.linalg.svd(own, full_matrices=False)
    if sizes[1] < 1e-6 * max(sizes[0], 1e-300):
        return ()
    angles = np.arctan2(own @ axes[1], own @ axes[0])
    return tuple(int(indices[k]) for k in np.argsort(angles, kind="stable"))


@lru_cache(maxsize=64)
def _fine_box(x: float, y: float, z: float) -> str:
    """Return a box with squares on its sides and a core within, as VTK text."""
    size = np.array([x, y, z])
    core = 1 - _CORE * size.min() / size  # relative to the box
    points: dict[tuple[float, ...], int] = {}

    def number(point: np.ndarray) -> int:
        return points.setdefault(tuple(point.tolist()), len(points))

    corners = {signs: number(0.5 * core * size * signs) for signs in product((-1, 1), repeat=3)}
    cells = [[_around(corners, axis, side) for axis in range(3) for side in (-1, 1)]]
    squares = [_MORE_SQUARES if length >= 2 * size.min() else _SQUARES for length in size]
    cuts = [np.linspace(-0.5, 0.5, count + 1).tolist() for count in squares]
    for axis, side in product(range(3), (-1, 1)):
        one, other = (axis + 1) % 3, (axis + 2) % 3
        grid = [[number(np.roll((side / 2, i, j), axis) * size) for j in cuts[other]] for i in cuts[one]]
        polygons: list[Polygon] = [_around(corners, axis, side)]
        for i, j in product(range(squares[one]), range(squares[other])):
            a, b, c, d = grid[i][j], grid[i + 1][j], grid[i + 1][j + 1], grid[i][j + 1]
            polygons += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(b, c, d), (b, d, a)]
        # The walls between this side's part of the box and its neighbours' parts.
        for edge, first, second in (
            ([row[0] for row in grid], (-1, -1), (1, -1)),
            ([row[-1] for row in grid], (-1, 1), (1, 1)),
            (grid[0], (-1, -1), (-1, 1)),
            (grid[-1], (1, -1), (1, 1)),
        ):
            inner = [corners[tuple(np.roll((side, *signs), axis).tolist())] for signs in (first, second)]
            polygons.append((*edge, inner[1], inner[0]))
        cells.append(polygons)
    places = np.array(list(points))
    tetrahedra = tetrahedra_of(places, cells)
    return vtk_text(
        np.vstack([places[: len(corners)], _hollow(places[len(corners) :], _CORE * size.min() / 2)]), tetrahedra
    )


def _around(corners: dict[tuple[int, ...], int], axis: int, side: int) -> Polygon:
    """Return the corners of a side of a box, in order."""
    return tuple(
        corners[tuple(np.roll((side, *signs), axis).tolist())] for signs in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    )
