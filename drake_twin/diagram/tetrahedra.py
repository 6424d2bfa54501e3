"""Convex cells as tetrahedra, and these as VTK text."""

from collections import Counter
from collections.abc import Sequence
from itertools import combinations, pairwise

import numpy as np

Tetrahedron = tuple[int, int, int, int]
Polygon = tuple[int, ...]


def tetrahedra_of(points: np.ndarray, cells: Sequence[Sequence[Polygon]]) -> list[Tetrahedron]:
    """Divide convex cells, given by the polygons around each, into tetrahedra that meet face to face.

    A polygon is divided from its vertex of the lowest number, and so is a cell: neighbours divide alike what they
    share.
    """
    found = []
    for polygons in cells:
        top = min(min(polygon) for polygon in polygons)
        for polygon in polygons:
            if top in polygon:
                continue
            first = polygon.index(min(polygon))
            turned = polygon[first:] + polygon[:first]
            for one, other in pairwise(turned[1:]):
                a, b, c, d = (points[index] for index in (turned[0], one, other, top))
                volume = float(np.dot(np.cross(b - a, c - a), d - a))
                found.append((turned[0], one, other, top) if volume > 0 else (turned[0], other, one, top))
    return found


def is_closed(tetrahedra: Sequence[Tetrahedron], count: int) -> bool:
    """Tell whether tetrahedra meet face to face but for so many faces at their surface."""
    times = Counter(tuple(sorted(face)) for each in tetrahedra for face in combinations(each, 3))
    return max(times.values()) == 2 and sum(number == 1 for number in times.values()) == count


def vtk_text(points: np.ndarray, tetrahedra: Sequence[Tetrahedron]) -> str:
    """Return tetrahedra as VTK text."""
    lines = ["# vtk DataFile Version 3.0", "yielding shape", "ASCII", "DATASET UNSTRUCTURED_GRID"]
    lines += [f"POINTS {len(points)} double", *(" ".join(map(repr, row)) for row in points.tolist())]
    lines += [f"CELLS {len(tetrahedra)} {5 * len(tetrahedra)}", *(f"4 {a} {b} {c} {d}" for a, b, c, d in tetrahedra)]
    return "\n".join([*lines, f"CELL_TYPES {len(tetrahedra)}", *["10"] * len(tetrahedra), ""])
