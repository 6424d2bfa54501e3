"""The normals of a mesh that has none: smooth over round surfaces, and sharp at edges."""

import numpy as np

CREASE = np.radians(30.0)  # between the normals of two triangles: an edge that is less sharp is smooth


def creased_normals(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the normals of triangles' corners.

    The triangles around a vertex that follow each other over smooth edges share a normal: the mean of theirs, weighted
    by their angles at the vertex.

    Args:
        vertices: The vertices (m), shape (N, 3); triangles that touch share them.
        faces: The indices of the triangles' vertices, shape (M, 3).

    Returns:
        Unit normals, shape (K, 3), and the index of each corner's normal, shape (M, 3).
    """
    from scipy.sparse import coo_matrix  # SciPy 1.11 finds no components of an array's 64-bit indices
    from scipy.sparse.csgraph import connected_components

    corners = vertices[faces]
    towards_next = _units(np.roll(corners, -1, axis=1) - corners)
    towards_last = -np.roll(towards_next, 1, axis=1)
    angles = np.arccos(np.clip(np.einsum("ijk,ijk->ij", towards_next, towards_last), -1.0, 1.0))
    of_faces = _units(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))

    first, second = _smooth_edges(faces, of_faces)
    size = faces.size
    links = coo_matrix((np.ones(len(first), bool), (first, second)), shape=(size, size))
    count, index = connected_components(links, directed=False)
    normals = np.zeros((count, 3))
    np.add.at(normals, index, (angles[:, :, None] * of_faces[:, None, :]).reshape(-1, 3))
    normals = _units(normals)
    normals[~normals.any(axis=1)] = [0.0, 0.0, 1.0]  # of triangles without an area
    return normals, index.reshape(faces.shape)


def _smooth_edges(faces: np.ndarray, of_faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return pairs of corners, numbered through all faces, that two triangles have at the ends of a smooth edge."""
    starts = np.arange(faces.size)  # the edge of a corner leads to the next corner of its triangle
    ends = np.roll(starts.reshape(faces.shape), -1, axis=1).ravel()
    flat = faces.ravel()
    is_turned = flat[starts] > flat[ends]
    low, high = np.where(is_turned, ends, starts), np.where(is_turned, starts, ends)
    order = np.lexsort((flat[high], flat[low]))
    low, high = low[order], high[order]
    is_shared = (flat[low[1:]] == flat[low[:-1]]) & (flat[high[1:]] == flat[high[:-1]])
    turns = np.einsum("ij,ij->i", of_faces[low[1:] // 3], of_faces[low[:-1] // 3])
    chosen = np.flatnonzero(is_shared & (turns > np.cos(CREASE)))
    return np.concatenate([low[chosen], high[chosen]]), np.concatenate([low[chosen + 1], high[chosen + 1]])


def _units(vectors: np.ndarray) -> np.ndarray:
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.where(lengths > 0.0, lengths, 1.0))
