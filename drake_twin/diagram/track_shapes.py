"""The boxes of tracks, as meshes on which a vehicle turns as friction along the whole of them lets it."""

from functools import lru_cache
from itertools import pairwise, product

import numpy as np

from drake_twin.diagram.tetrahedra import Tetrahedron, vtk_text

# Squares along the longest side, and at least along the shortest one. Drake applies the friction of a facet at its
# middle: so many are 0.6 % from the moment of friction that is spread over a face, and Drake's own box 25 to 60 %.
_MOST, _LEAST = 8, 2


@lru_cache(maxsize=64)
def soft_box(x: float, y: float, z: float) -> str:
    """Return a box (m) with squares on its sides, and a pressure that rises to its middle, as VTK text."""
    points, triangles = _surface(x, y, z)
    tetrahedra: list[Tetrahedron] = [(a, b, c, len(points)) for a, b, c in triangles]
    return vtk_text(np.vstack([points, np.zeros(3)]), tetrahedra)


@lru_cache(maxsize=64)
def hard_box(x: float, y: float, z: float) -> str:
    """Return the surface of a box (m) with squares on its sides, as OBJ text."""
    points, triangles = _surface(x, y, z)
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
    return "\n".join([*lines, *(f"f {c + 1} {b + 1} {a + 1}" for a, b, c in triangles)])


def _surface(x: float, y: float, z: float) -> tuple[np.ndarray, list[tuple[int, int, int]]]:
    """Return points (n×3, m) and triangles, which are clockwise from outside."""
    size = np.array([x, y, z])
    cuts = [np.linspace(-0.5, 0.5, 1 + max(round(_MOST * length / size.max()), _LEAST)).tolist() for length in size]
    points: dict[tuple[float, ...], int] = {}

    def number(place: np.ndarray) -> int:
        return points.setdefault(tuple(place.tolist()), len(points))

    triangles: list[tuple[int, int, int]] = []
    for axis, side in product(range(3), (-1, 1)):
        one, other = (axis + 1) % 3, (axis + 2) % 3
        grid = [[number(np.roll((side / 2, i, j), axis) * size) for j in cuts[other]] for i in cuts[one]]
        for i, (row, beside) in enumerate(pairwise(grid)):
            for j, ((a, d), (b, c)) in enumerate(zip(pairwise(row), pairwise(beside), strict=True)):
                halves = [(a, b, c), (a, c, d)] if (i + j) % 2 else [(b, c, d), (b, d, a)]
                triangles += halves if side < 0 else [(p, q, r) for r, q, p in halves]
    return np.array(list(points)), triangles
