"""Arrows of one shaft and one head each, which are stretched and turned by their poses."""

import numpy as np


def arrow_poses(points: np.ndarray, vectors: np.ndarray, head: float) -> np.ndarray:
    """Return the poses of all arrows in the world, then of their shafts and of their heads, shape (3 n, 4, 4).

    A shaft is a cylinder of 1 m, a head a `MeshcatCone`, which stands on its tip; both are below their arrow.

    Args:
        points: Where they begin (m), shape (n, 3).
        vectors: How far their shafts reach from there (m), shape (n, 3); none is zero.
        head: How long a head is (m).
    """
    count = len(points)
    lengths = np.linalg.norm(vectors, axis=1)
    z = vectors / lengths[:, None]
    x = np.cross(np.where(np.abs(z[:, :1]) < 0.9, [[1.0, 0, 0]], [[0, 1.0, 0]]), z)
    x /= np.linalg.norm(x, axis=1)[:, None]
    poses = np.tile(np.eye(4), (3 * count, 1, 1))
    arrows, shafts, heads = poses[:count], poses[count : 2 * count], poses[2 * count :]
    arrows[:, :3, :3] = np.stack([x, np.cross(z, x), z], axis=2)
    arrows[:, :3, 3] = points
    shafts[:, 2, 2] = np.maximum(lengths, 1e-6)
    shafts[:, 2, 3] = lengths / 2
    heads[:, 1, 1] = heads[:, 2, 2] = -1.0
    heads[:, 2, 3] = lengths + head
    return poses
