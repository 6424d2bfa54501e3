"""What is wrong with the triangles of a mesh."""

from collections.abc import Iterator

import numpy as np

from drake_twin.dataclass import dataclass

_SAME = 2.0**-20  # corners closer than this part of the mesh's size are one
_NO_AREA = 1e-12  # of a triangle, relative to the size squared
_FLAT = 1e-6  # relative to the size
THINNEST = 1e-3  # relative to the size: hulls of thinner meshes are made thicker, because Drake needs volume
_NO_VOLUME = 1e-9  # relative to the size cubed

_FEW = 0.02  # of a mesh's triangles or edges: so many faults have most meshes of robots

_MOST_CORNERS = 2**21  # of a mesh whose edges are examined: three of them are one number of 63 bits


@dataclass(frozen=True)
class MeshFaults:
    """What is wrong with the triangles of a mesh.

    Attributes:
        triangles: The number of triangles with corners in space.
        unplaced: The number of those with a corner that is not a finite point.
        degenerate: The number of those without area.
        doubled: The number of those that are there once more, facing the same way.
        two_sided: The number of those that are there once more, facing the other way.
        open_edges: The number of edges of one triangle.
        crowded_edges: The number of edges of more than two triangles.
        turned_edges: The number of edges whose triangles face opposite ways.
        is_thin: Whether the mesh is thinner than `THINNEST`, in any direction.
        dimensions: 3; 2 where all corners are in one plane, 1 on a line, 0 in a point.
        is_inside_out: Whether the triangles enclose a volume and face into it.
    """

    triangles: int
    unplaced: int = 0
    degenerate: int = 0
    doubled: int = 0
    two_sided: int = 0
    open_edges: int = 0
    crowded_edges: int = 0
    turned_edges: int = 0
    is_thin: bool = False
    dimensions: int = 3
    is_inside_out: bool = False

    @property
    def is_poor_surface(self) -> bool:
        """Whether more than a few triangles or edges are not those of the surface of a solid, but for openings."""
        triangles, edges = self.degenerate + self.doubled, self.crowded_edges + self.turned_edges
        return triangles > _FEW * self.triangles or edges > _FEW * 1.5 * self.triangles

    @property
    def unplaced_text(self) -> str:
        """Those without a place, as words."""
        return f"{_count(self.unplaced, 'triangle')} with corners that are not finite numbers"

    def of_solid(self) -> Iterator[str]:
        """Yield what is wrong with the mesh even where only its outermost corners count."""
        whole = self.triangles - self.degenerate
        if self.unplaced:
            yield self.unplaced_text
        if self.dimensions < 3:
            yield ("all corners in one point", "all corners on one line", "all corners in one plane")[self.dimensions]
        elif self.is_thin:
            yield f"less thickness than {THINNEST:g} of its size"
        if self.is_inside_out:
            yield "triangles that face inwards"
        if self.two_sided and 2 * self.two_sided >= whole - self.doubled:
            yield "each triangle twice, facing opposite ways"

    def of_surface(self) -> Iterator[str]:
        """Yield what else is wrong with the mesh where each of its triangles counts."""
        if self.degenerate:
            yield f"{_count(self.degenerate, 'triangle')} without area"
        if self.doubled:
            yield f"{_count(self.doubled, 'triangle')} twice"
        if self.crowded_edges:
            yield f"{_count(self.crowded_edges, 'edge')} of more than two triangles"
        if self.turned_edges:
            yield f"{_count(self.turned_edges, 'edge')} between triangles that face opposite ways"


def faults_of(vertices: np.ndarray, faces: np.ndarray, unplaced: int = 0) -> MeshFaults:
    """Examine triangles.

    Args:
        vertices: The corners (n×3).
        faces: Three indices of corners for each triangle (m×3), counterclockwise seen from outside.
        unplaced: How many more triangles the file has, without a place in space.
    """
    total = len(faces)
    corners, places = _at_one_place(vertices)
    extents = _extents(corners)
    dimensions, is_thin = sum(each > _FLAT for each in extents), min(extents) < THINNEST
    faces = places[faces]
    normals = _normals(corners, faces)
    size = float(np.ptp(vertices, axis=0).max())
    has_area = np.einsum("ij,ij->i", normals, normals) > (_NO_AREA * size**2) ** 2
    faces, normals = faces[has_area], normals[has_area]
    degenerate = total - len(faces)
    if len(faces) == 0 or len(corners) > _MOST_CORNERS:
        return MeshFaults(total, unplaced, degenerate, is_thin=is_thin, dimensions=dimensions)
    a, b, c = np.sort(faces, axis=1).astype(np.uint64).T
    is_odd = (np.diff(faces[:, [0, 1, 2, 0]], axis=1) > 0).sum(axis=1) == 1
    keys = (a << np.uint64(43)) | (b << np.uint64(22)) | (c << np.uint64(1)) | is_odd.astype(np.uint64)
    different = np.unique(keys)
    first = np.unique(keys >> np.uint64(1), return_index=True)[1]
    faces, normals = faces[first], normals[first]
    count = len(corners)
    edges = (count * faces + np.roll(faces, -1, axis=1)).ravel()  # from one corner to the next
    between = np.minimum(edges, edges % count * count + edges // count)
    _, place, times = np.unique(between, return_inverse=True, return_counts=True)
    of_two = edges[times[place.reshape(-1)] == 2]
    open_edges = int((times == 1).sum())
    volume = float(np.einsum("ij,ij->", corners[faces[:, 0]] - corners.mean(axis=0), normals))
    return MeshFaults(
        triangles=total,
        unplaced=unplaced,
        degenerate=degenerate,
        doubled=len(keys) - len(different),
        two_sided=len(different) - len(first),
        open_edges=open_edges,
        crowded_edges=int((times > 2).sum()),
        turned_edges=len(of_two) - len(np.unique(of_two)),
        is_thin=is_thin,
        dimensions=dimensions,
        is_inside_out=open_edges == 0 and volume < -_NO_VOLUME * size**3,
    )


def _at_one_place(vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the different corners (k×3), and the number of each one's corner (n)."""
    lower, size = vertices.min(axis=0), float(np.ptp(vertices, axis=0).max()) or 1.0
    x, y, z = np.round((vertices - lower) / (_SAME * size)).astype(np.int64).T
    _, first, places = np.unique((x << 42) | (y << 21) | z, return_index=True, return_inverse=True)
    return vertices[first], places.reshape(-1)


def _normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Return the directions of triangles, as long as twice their areas."""
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    return np.cross(b - a, c - a)


def _extents(corners: np.ndarray) -> list[float]:
    """Return how far corners reach along the three directions of their spread, relative to their size."""
    centered = corners - corners.mean(axis=0)
    size = float(np.abs(centered).max())
    if size == 0:
        return [0.0, 0.0, 0.0]
    _, directions = np.linalg.eigh((centered / size).T @ (centered / size))
    return [float(np.ptp(centered @ direction)) / size for direction in directions.T]


def _count(number: int, noun: str) -> str:
    return f"{number:,} {noun}{'' if number == 1 else 's'}"
