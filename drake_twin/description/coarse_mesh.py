"""Triangles of meshes: corners at one place as one corner, and fewer triangles."""

import numpy as np


def merged(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Merge corners at one place, and remove triangles without area."""
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


def coarser(vertices: np.ndarray, faces: np.ndarray, detail: float) -> tuple[np.ndarray, np.ndarray]:
    """Move corners to the mean of those within a cube."""
    used, faces = np.unique(faces, return_inverse=True)
    vertices = vertices[used]
    _, index = np.unique(np.floor(vertices / detail), axis=0, return_inverse=True)
    index = index.reshape(-1)
    count = np.bincount(index)
    middle = np.stack([np.bincount(index, weights=vertices[:, axis]) / count for axis in range(3)], axis=1)
    return _clean(middle, index[faces.reshape(-1, 3)])
