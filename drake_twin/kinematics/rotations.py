"""Rotations of many frames at once. Quaternions are (w, x, y, z), as in Drake."""

from math import atan2, cos, sin

import numpy as np


def heading_of(w: float, x: float, y: float, z: float) -> float:
    """Return the yaw of a unit quaternion (rad)."""
    return atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def along_heading(heading: float, x: float, y: float) -> tuple[float, float]:
    """Return the components of a planar vector forwards and to the left of a heading (rad)."""
    return cos(heading) * x + sin(heading) * y, cos(heading) * y - sin(heading) * x


def quaternion_from_rpy(rpy: np.ndarray) -> np.ndarray:
    """Return unit quaternions, shape (n, 4), of roll, pitch, yaw about fixed axes (rad), shape (n, 3)."""
    half = 0.5 * np.atleast_2d(rpy)
    (cr, cp, cy), (sr, sp, sy) = np.cos(half).T, np.sin(half).T
    return np.stack(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ],
        axis=1,
    )


def quaternion_product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return quaternion products row by row, which rotate by b, then by a; shapes (n, 4)."""
    aw, ax, ay, az = a.T
    bw, bx, by, bz = b.T
    return np.stack(
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ],
        axis=1,
    )


def rotated(quaternions: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Return vectors rotated by unit quaternions, row by row; shapes (n, 4) and (n, 3)."""
    w, u = quaternions[:, :1], quaternions[:, 1:]
    twice_cross = 2.0 * np.cross(u, vectors)
    return np.asarray(vectors + w * twice_cross + np.cross(u, twice_cross))
