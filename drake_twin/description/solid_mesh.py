"""A mesh that does not move as convex solids: Drake's point contact would replace any other mesh by its convex hull.

A room, a terrain or a shelf is not its hull. So each connected part of a mesh that is convex becomes its hull, and each
flat face of the other parts becomes a slab, with its upper side at the face. A slab ends halfway to the other side of
the mesh, where the slab of that side begins: a table top of 5 mm is 5 mm thick, a cup's walls leave its inside free.
"""

import io
import json
from collections import defaultdict
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.description.coarse_mesh import coarser, merged
from drake_twin.description.mesh_cache import cached
from drake_twin.description.meshes import read_triangles, with_thickness
from drake_twin.errors import InputError

# A part is replaced by its hull when no face is deeper inside the hull than this part of its diagonal.
_CONVEX = 0.01

# Faces are in one plane when their corners leave it by no more than this part of the diagonal.
_FLAT = 2e-4

THICKNESS = 0.05  # m: of a slab behind its face, where the mesh's other side is farther away
_THINNEST = 1e-4  # m: of a slab, also where two sides of a mesh are one
_INSIDE = 1e-3  # from a corner towards the middle of its face, where the thickness behind the corner is measured
_BEHIND = 1e-5  # relative to the mesh's size: where a ray starts behind its face

# A mesh of more triangles is divided into cells of at least this part of its size.
_MANY_TRIANGLES = 50_000
_FINEST = 1 / 256


@dataclass(frozen=True)
class SolidMesh:
    """The collision shape of a static mesh, in the mesh's own units.

    Attributes:
        hulls: The corners of each convex part, n × 3.
        faces: The corners of each convex face of the other parts, n × 3, counterclockwise seen from outside.
        depths: How far the mesh's other side is behind each of these corners, n; infinite where it has no other side.
    """

    hulls: tuple[np.ndarray, ...]
    faces: tuple[np.ndarray, ...]
    depths: tuple[np.ndarray, ...]

    def __len__(self) -> int:
        """Count the solids."""
        return len(self.hulls) + len(self.faces)

    def solids(self, scale: tuple[float, float, float]) -> list[np.ndarray]:
        """Return the corners of every convex solid, 3 × n (m).

        Args:
            scale: The mesh's scale along its axes.
        """
        found = [(hull * scale).T for hull in self.hulls]
        mirrored = np.prod(np.sign(scale))
        for face, depths in zip(self.faces, self.depths, strict=True):
            corners = face * scale
            normal = mirrored * np.cross(corners[1] - corners[0], corners[2] - corners[1])
            length = np.linalg.norm(normal)
            if length > 0:
                stretched = depths / np.linalg.norm(_normal(face) / scale)
                thickness = np.clip(stretched / 2, _THINNEST, THICKNESS)[:, np.newaxis]
                found.append(np.vstack([corners, corners - thickness * normal / length]).T)
        return found


def solid_mesh(file: Path, detail: float = 0.0) -> SolidMesh:
    """Divide a mesh file into convex solids, which are kept in the cache of meshes.

    Args:
        file: The mesh file.
        detail: The size below which features may be merged (in the mesh's units); zero keeps every corner.

    Raises:
        InputError: If the file cannot be read, or holds no triangles.
    """
    digits = float(f"{detail:.3g}")
    data = json.loads(cached(file, f".solids-{digits:g}.json", lambda source: _solids_json(source, digits)).read_text())
    return SolidMesh(
        *(tuple(np.array(item, dtype=float) for item in data[name]) for name in ("hulls", "faces", "depths"))
    )


def _solids_json(file: Path, detail: float) -> bytes:
    with np.load(io.BytesIO(cached(file, ".triangles.npz", _triangles).read_bytes())) as triangles:
        vertices, faces = triangles["vertices"], triangles["faces"]
    if len(faces) > _MANY_TRIANGLES:
        detail = max(detail, _FINEST * float(np.ptp(vertices, axis=0).max()))
    hulls: list[Any] = []
    slabs: list[np.ndarray] = []
    hollow_parts: list[np.ndarray] = []
    small: dict[tuple[int, ...], list[np.ndarray]] = defaultdict(list)
    parts = _parts(len(vertices), faces)
    hollow = _hollow(vertices, [faces[part] for part in parts])
    for number, part in enumerate(parts):
        corners = None if number in hollow else _convex_part(vertices, faces[part])
        points = vertices[np.unique(faces[part])] if corners is None else corners
        if detail > 0 and float(np.ptp(points, axis=0).max()) < detail:
            small[tuple(np.floor(points.mean(axis=0) / detail).astype(int).tolist())].append(points)
        elif corners is not None:
            hulls.append(corners.tolist())
        else:
            own = (vertices, faces[part]) if detail == 0 else coarser(vertices, faces[part], detail)
            polygons = _polygons(*own)
            slabs += polygons
            hollow_parts.append(own[0][own[1]])
            hulls += [] if polygons else [with_thickness(points).tolist()]  # thinner than the detail
    hulls += [with_thickness(np.vstack(group)).tolist() for group in small.values()]  # one cell is one solid
    if not hulls and not slabs:
        raise InputError("the mesh has no face that can be touched", file=file)
    depths = _depths(slabs, np.concatenate(hollow_parts)) if slabs else []
    faces_and_depths = {"faces": [slab.tolist() for slab in slabs], "depths": [each.tolist() for each in depths]}
    return json.dumps({"hulls": hulls} | faces_and_depths).encode()


def _depths(polygons: list[np.ndarray], triangles: np.ndarray) -> list[np.ndarray]:
    """Measure how far behind each corner of polygons the triangles (m×3×3) of their mesh are; infinity for none.

    Between the corners the mesh may be thinner, as above a rib: then all corners of the polygon count as thinner.
    """
    import trimesh
    from trimesh.ray.ray_pyembree import RayMeshIntersector

    mesh = trimesh.Trimesh(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3), process=False)
    size = float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
    shares = [_shares(len(polygon)) for polygon in polygons]
    normals = [_normal(polygon) for polygon in polygons]
    starts = np.concatenate(
        [share @ polygon - _BEHIND * size * n for share, polygon, n in zip(shares, polygons, normals, strict=True)]
    )
    directions = np.concatenate([np.tile(-n, (len(share), 1)) for share, n in zip(shares, normals, strict=True)])
    places, rays, _ = RayMeshIntersector(mesh).intersects_location(starts, directions, multiple_hits=False)
    gaps = np.full(len(starts), np.inf)
    gaps[rays] = np.linalg.norm(places - starts[rays], axis=1) + _BEHIND * size
    found, first = [], 0
    for polygon, share in zip(polygons, shares, strict=True):
        own = gaps[first : first + len(share)]
        first += len(share)
        if np.isinf(own).all():
            found.append(np.full(len(polygon), np.inf))
            continue
        own = np.minimum(own, 2 * own[np.isfinite(own)].max())
        corners, between = own[: len(polygon)], own[len(polygon) :]
        interpolated = share[len(polygon) :] @ corners
        found.append(corners * min(1.0, float((between / np.maximum(interpolated, 1e-300)).min())))
    return found


@lru_cache(maxsize=64)
def _shares(count: int) -> np.ndarray:
    """Return the weights of a polygon's corners in the places where it is measured: at its corners, then between."""
    near = (1 - _INSIDE) * np.eye(count) + _INSIDE / count
    halfway = 0.5 * np.eye(count) + 0.5 / count
    edges = 0.45 * (np.eye(count) + np.roll(np.eye(count), 1, axis=1)) + 0.1 / count
    return np.vstack([near, halfway, edges, np.full((1, count), 1 / count)])


def _normal(polygon: np.ndarray) -> np.ndarray:
    """Return the direction (unit vector) that a polygon faces."""
    following = np.roll(polygon, -1, axis=0)
    normal = np.cross(polygon - polygon[0], following - polygon[0]).sum(axis=0)
    return np.asarray(normal / max(float(np.linalg.norm(normal)), 1e-300))


def _triangles(file: Path) -> bytes:
    mesh = read_triangles(file)
    vertices, faces = merged(np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces))
    data = io.BytesIO()
    np.savez(data, vertices=vertices, faces=faces)
    return data.getvalue()


def _hollow(vertices: np.ndarray, parts: list[np.ndarray]) -> set[int]:
    """Find the parts that are a cavity in another one (they face inwards, as a room in a house), and those others."""
    lower = np.array([vertices[part].min(axis=(0, 1)) for part in parts]).reshape(-1, 3)
    upper = np.array([vertices[part].max(axis=(0, 1)) for part in parts]).reshape(-1, 3)
    found: set[int] = set()
    for number, part in enumerate(parts):
        a, b, c = (vertices[part[:, corner]] - lower[number] for corner in range(3))
        if float(np.einsum("ij,ij->", a, np.cross(b, c))) < 0:
            around = np.nonzero(np.all(lower < lower[number], axis=1) & np.all(upper > upper[number], axis=1))[0]
            found |= {number, *around.tolist()} if len(around) else set()
    return found


def _parts(count: int, faces: np.ndarray) -> list[np.ndarray]:
    """Return the indices of the faces of each connected part."""
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
    """Return the corners of a part's hull, where the part is nearly convex; None otherwise."""
    from scipy.spatial import ConvexHull, QhullError

    points = vertices[np.unique(faces)]
    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError):  # flat
        return None
    tolerance = _CONVEX * float(np.linalg.norm(np.ptp(points, axis=0)))
    # How far the hull reaches beyond each face, in the direction that the face has: the floor of a tray is near to its
    # hull only downwards.
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    if float(np.einsum("ij,ij->", a - points[0], normals)) < 0:
        normals = -normals  # the part is inside out
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    inside = -((a + b + c) / 3 @ hull.equations[:, :3].T + hull.equations[:, 3])
    towards = normals @ hull.equations[:, :3].T
    depth = np.where(towards > 1e-9, inside / np.maximum(towards, 1e-9), np.inf).min(axis=1)
    # An open sheet, such as a terrain, may be nearly flat, and is not the solid that its hull encloses.
    if depth.max() > tolerance or _area(vertices, faces) < 0.75 * float(hull.area):
        return None
    return np.asarray(points[hull.vertices])


def _area(vertices: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def _polygons(vertices: np.ndarray, faces: np.ndarray) -> list[np.ndarray]:
    """Cover the faces with convex polygons: neighbouring triangles in one plane are merged, where that is convex."""
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
    normal = np.cross(b - a, c - a) / np.linalg.norm(np.cross(b - a, c - a))
    x = (b - a) / np.linalg.norm(b - a)
    y = np.cross(normal, x)
    corners = vertices[np.unique(faces)]
    if np.ptp(corners @ normal) > _FLAT * float(np.linalg.norm(np.ptp(corners, axis=0))):
        return None  # neighbours bend little by little
    try:
        hull = ConvexHull(corners @ np.stack([x, y], axis=1))
    except (QhullError, ValueError):
        return None
    return np.asarray(corners[hull.vertices]) if hull.volume < 1.001 * _area(vertices, faces) else None
