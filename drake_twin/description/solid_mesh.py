"""A mesh that does not move as convex solids: Drake's point contact takes any other mesh for its convex hull.

A room, a terrain or a shelf is not its hull. So each connected part of a mesh that is convex becomes its hull, and of
the others every flat face becomes a slab, its upper side where the face is.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from drake_twin.description.mesh_cache import cached
from drake_twin.description.meshes import read_triangles
from drake_twin.errors import InputError

# A part stands for its hull when none of its faces lies deeper inside the hull than this part of its diagonal.
_CONVEX = 0.01

_THICKNESS = 0.05  # m: what a slab has behind its face

# Of one mesh; building a plant takes time with their square (1,000: 0.3 s).
MOST_SOLIDS = 1000


@dataclass(frozen=True)
class SolidMesh:
    """What a static mesh collides as, in the mesh's own units.

    Attributes:
        hulls: the corners of each convex part, n × 3.
        faces: the corners of each convex face of the other parts, n × 3, counterclockwise seen from outside.
        is_coarser: whether corners were moved to keep the number of solids bearable.
    """

    hulls: tuple[np.ndarray, ...]
    faces: tuple[np.ndarray, ...]
    is_coarser: bool = False

    def solids(self, scale: tuple[float, float, float]) -> list[np.ndarray]:
        """The corners of every convex solid, 3 × n (m).

        Args:
            scale: the mesh's scale along its axes.
        """
        found = [(hull * scale).T for hull in self.hulls]
        mirrored = np.prod(np.sign(scale))
        for face in self.faces:
            corners = face * scale
            normal = mirrored * np.cross(corners[1] - corners[0], corners[2] - corners[1])
            length = np.linalg.norm(normal)
            if length > 0:
                found.append(np.vstack([corners, corners - _THICKNESS * normal / length]).T)
        return found


def solid_mesh(file: Path) -> SolidMesh:
    """A mesh file divided into convex solids; kept in the cache of meshes.

    Raises:
        InputError: the file cannot be read, or holds no triangles.
    """
    data = json.loads(cached(file, ".solids.json", _solids_json).read_text())
    hulls, faces = ([np.array(points, dtype=float) for points in data[name]] for name in ("hulls", "faces"))
    return SolidMesh(tuple(hulls), tuple(faces), data["is_coarser"])


def _solids_json(file: Path) -> bytes:
    mesh = read_triangles(file)
    vertices, faces = _merged(np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces))
    hulls, slabs = _divided(vertices, faces)
    cells, is_coarser = 128, False
    while len(hulls) + len(slabs) > MOST_SOLIDS and cells >= 4:
        is_coarser = True
        hulls, slabs = _divided(*_coarser(vertices, faces, cells))
        cells = int(cells / 1.5)
    if not hulls and not slabs:
        raise InputError("the mesh has no face that something can touch", file=file)
    return json.dumps({"hulls": hulls, "faces": slabs, "is_coarser": is_coarser}).encode()


def _divided(vertices: np.ndarray, faces: np.ndarray) -> tuple[list[Any], list[Any]]:
    """Hulls of the convex parts, and the faces of the others."""
    hulls: list[Any] = []
    slabs: list[Any] = []
    for part in _parts(len(vertices), faces):
        corners = _convex_part(vertices, faces[part])
        if corners is not None:
            hulls.append(corners.tolist())
        else:
            slabs += [polygon.tolist() for polygon in _polygons(vertices, faces[part])]
    return hulls, slabs


def _merged(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners at one place become one corner, and triangles without area go."""
    size = float(np.ptp(vertices, axis=0).max()) or 1.0
    _, first, index = np.unique(np.round(vertices / (1e-6 * size)), axis=0, return_index=True, return_inverse=True)
    return _clean(vertices[first], index.reshape(-1)[faces])


def _clean(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    size = float(np.ptp(vertices, axis=0).max()) or 1.0
    faces = faces[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-9 * size**2]
    _, kept = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    return vertices, faces[np.sort(kept)]


def _coarser(vertices: np.ndarray, faces: np.ndarray, cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Corners moved to the middle of those within a cube; so many cubes along the longest side."""
    lower = vertices.min(axis=0)
    cube = float(np.ptp(vertices, axis=0).max()) / cells
    _, index = np.unique(np.floor((vertices - lower) / cube), axis=0, return_inverse=True)
    index = index.reshape(-1)
    count = np.bincount(index)
    middle = np.stack([np.bincount(index, weights=vertices[:, axis]) / count for axis in range(3)], axis=1)
    return _clean(middle, index[faces])


def _parts(count: int, faces: np.ndarray) -> list[np.ndarray]:
    """Indices of the faces of each connected part."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    if len(faces) == 0:
        return []
    rows = np.concatenate([faces[:, 0], faces[:, 1]])
    columns = np.concatenate([faces[:, 1], faces[:, 2]])
    graph = coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(count, count))
    label = connected_components(graph, directed=False)[1][faces[:, 0]]
    order = np.argsort(label, kind="stable")
    return np.split(order, np.nonzero(np.diff(label[order]))[0] + 1)


def _convex_part(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray | None:
    """The corners of a part's hull, where the part is as good as convex."""
    from scipy.spatial import ConvexHull, QhullError

    points = vertices[np.unique(faces)]
    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError):  # flat
        return None
    tolerance = _CONVEX * float(np.linalg.norm(np.ptp(points, axis=0)))
    inside = np.concatenate([points, vertices[faces].mean(axis=1)])
    depth = -(inside @ hull.equations[:, :3].T + hull.equations[:, 3]).max(axis=1)
    # An open sheet, such as a terrain, may be as good as flat, and is not what its hull encloses.
    if depth.max() > tolerance or _area(vertices, faces) < 0.75 * float(hull.area):
        return None
    return np.asarray(points[hull.vertices])


def _area(vertices: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def _polygons(vertices: np.ndarray, faces: np.ndarray) -> list[np.ndarray]:
    """Convex polygons that cover the faces: neighbouring triangles in one plane together, where that is convex."""
    polygons: list[np.ndarray] = []
    rest = np.ones(len(faces), dtype=bool)
    for group in _flat_groups(vertices, faces):
        if len(group) > 1 and (polygon := _convex_polygon(vertices, faces[group])) is not None:
            polygons.append(polygon)
            rest[group] = False
    return [*polygons, *vertices[faces[rest]]]


def _flat_groups(vertices: np.ndarray, faces: np.ndarray) -> list[np.ndarray]:
    import trimesh

    mesh = trimesh.Trimesh(vertices, faces, process=False)
    return [np.asarray(group) for group in mesh.facets]


def _convex_polygon(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray | None:
    from scipy.spatial import ConvexHull, QhullError

    a, b, c = vertices[faces[0]]
    normal = np.cross(b - a, c - a)
    x = (b - a) / np.linalg.norm(b - a)
    y = np.cross(normal / np.linalg.norm(normal), x)
    corners = vertices[np.unique(faces)]
    try:
        hull = ConvexHull(corners @ np.stack([x, y], axis=1))
    except (QhullError, ValueError):
        return None
    return np.asarray(corners[hull.vertices]) if hull.volume < 1.001 * _area(vertices, faces) else None
