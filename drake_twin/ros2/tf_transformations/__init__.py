"""Stand-in for ``tf_transformations``: Euler angles, quaternions (x, y, z, w) and 4×4 matrices, by SciPy and NumPy.

It lacks what robots hardly use: shear, projection, clipping, superimposition, ``decompose_matrix`` and ``Arcball``.
"""

import warnings
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

_Array = Any  # a NumPy array
_Numbers = Any  # a sequence of numbers, or an array
_Quaternion = tuple[float, float, float, float]


def identity_matrix() -> _Array:
    """Return the 4×4 identity."""
    return np.eye(4)


def translation_matrix(direction: _Numbers) -> _Array:
    """Return the matrix of a translation."""
    return _matrix(Rotation.identity(), direction)


def translation_from_matrix(matrix: _Numbers) -> _Array:
    """Return the translation of a matrix."""
    return np.array(matrix)[:3, 3]


def rotation_matrix(angle: float, direction: _Numbers, point: _Numbers = None) -> _Array:
    """Return the matrix of a rotation by an angle (rad) about an axis through a point, the origin by default."""
    rotation = _about(angle, direction)
    centre = np.zeros(3) if point is None else np.array(point, dtype=float)[:3]
    return _matrix(rotation, centre - rotation.apply(centre))


def rotation_from_matrix(matrix: _Numbers) -> tuple[float, np.ndarray, np.ndarray]:
    """Return the angle (rad), the axis and a point on the axis (four numbers) of a rotation's matrix."""
    matrix = np.array(matrix, dtype=float)
    turn = Rotation.from_matrix(matrix[:3, :3]).as_rotvec()
    angle = float(np.linalg.norm(turn))
    axis = turn / angle if angle else np.array([1.0, 0.0, 0.0])
    point = np.linalg.lstsq(np.eye(3) - matrix[:3, :3], matrix[:3, 3], rcond=None)[0]
    return angle, axis, np.append(point, 1.0)


def euler_matrix(ai: float, aj: float, ak: float, axes: Any = "sxyz") -> _Array:
    """Return the matrix of a rotation by three angles (rad) about axes that stay (``s…``) or turn along (``r…``)."""
    return _matrix(Rotation.from_euler(_sequence(axes), [ai, aj, ak]))


def euler_from_matrix(matrix: _Numbers, axes: Any = "sxyz") -> tuple[float, float, float]:
    """Return the three angles (rad) of a matrix's rotation."""
    return _angles(Rotation.from_matrix(np.array(matrix, dtype=float)[:3, :3]), axes)


def euler_from_quaternion(quaternion: _Numbers, axes: Any = "sxyz") -> tuple[float, float, float]:
    """Return the three angles (rad) of a quaternion; those of one of length zero are zero."""
    return _angles(_rotation(quaternion), axes)


def quaternion_from_euler(ai: float, aj: float, ak: float, axes: Any = "sxyz") -> _Quaternion:
    """Return the quaternion of three angles (rad)."""
    return _quaternion(Rotation.from_euler(_sequence(axes), [ai, aj, ak]))


def quaternion_about_axis(angle: float, axis: _Numbers) -> _Quaternion:
    """Return the quaternion of a rotation by an angle (rad) about an axis."""
    return _quaternion(_about(angle, axis))


def quaternion_matrix(quaternion: _Numbers) -> _Array:
    """Return the matrix of a quaternion; that of one of length zero is the identity."""
    return _matrix(_rotation(quaternion))


def quaternion_from_matrix(matrix: _Numbers) -> _Quaternion:
    """Return the quaternion of a matrix's rotation; its w is not negative."""
    rotation = Rotation.from_matrix(np.array(matrix, dtype=float)[:3, :3])
    x, y, z, w = rotation.as_quat(canonical=True)
    return x, y, z, w


def quaternion_multiply(quaternion1: _Numbers, quaternion0: _Numbers) -> _Quaternion:
    """Return the product of two quaternions, of any length."""
    first, second = (np.array(each, dtype=float) for each in (quaternion1, quaternion0))
    x, y, z = first[3] * second[:3] + second[3] * first[:3] + np.cross(first[:3], second[:3])
    return x, y, z, first[3] * second[3] - first[:3] @ second[:3]


def quaternion_conjugate(quaternion: _Numbers) -> _Array:
    """Return the conjugate of a quaternion."""
    return np.array(quaternion, dtype=float) * (-1, -1, -1, 1)


def quaternion_inverse(quaternion: _Numbers) -> _Array:
    """Return the inverse of a quaternion, of any length."""
    return quaternion_conjugate(quaternion) / np.dot(quaternion, quaternion)


def quaternion_slerp(
    quat0: _Numbers, quat1: _Numbers, fraction: float, spin: int = 0, shortestpath: bool = True
) -> _Array:
    """Return the quaternion between two others, after some half turns more if there is spin."""
    first, second = unit_vector(quat0), unit_vector(quat1)
    if fraction in (0.0, 1.0):
        return first if fraction == 0.0 else second
    cosine = first @ second
    if shortestpath and cosine < 0:
        second, cosine = -second, -cosine
    angle = np.arccos(np.clip(cosine, -1, 1)) + spin * np.pi
    if abs(angle) < 4 * np.finfo(float).eps:
        return first
    return (np.sin((1 - fraction) * angle) * first + np.sin(fraction * angle) * second) / np.sin(angle)


def random_quaternion(rand: _Numbers = None) -> _Array:
    """Return a quaternion of three numbers in [0, 1), random ones by default: all rotations are as probable."""
    one, two, three = np.random.random(3) if rand is None else np.array(rand, dtype=float)
    inner, outer, first, second = np.sqrt(1 - one), np.sqrt(one), 2 * np.pi * two, 2 * np.pi * three
    parts = (inner * np.sin(first), inner * np.cos(first), outer * np.sin(second), outer * np.cos(second))
    return np.array(parts)


def random_rotation_matrix(rand: _Numbers = None) -> _Array:
    """Return the matrix of `random_quaternion`."""
    return quaternion_matrix(random_quaternion(rand))


def random_vector(size: Any) -> _Array:
    """Return random numbers in [0, 1)."""
    return np.random.random(size)


def vector_norm(data: _Numbers, axis: int | None = None, out: np.ndarray | None = None) -> Any:
    """Return the length of a vector, or the lengths of vectors along an axis."""
    found = np.linalg.norm(np.array(data, dtype=float), axis=axis)
    return _put(found, out)


def unit_vector(data: _Numbers, axis: int | None = None, out: np.ndarray | None = None) -> Any:
    """Return a vector, or vectors along an axis, of length one; one of length zero stays."""
    vectors = np.array(data, dtype=float)
    lengths = np.linalg.norm(vectors, axis=axis, keepdims=True)
    return _put(np.divide(vectors, lengths, out=vectors, where=lengths > 0), out)


def inverse_matrix(matrix: _Numbers) -> _Array:
    """Return the inverse of a matrix."""
    return np.linalg.inv(matrix)


def concatenate_matrices(*matrices: _Numbers) -> _Array:
    """Return the product of matrices."""
    found = np.eye(4)
    for matrix in matrices:
        found = found @ np.array(matrix)
    return found


def is_same_transform(matrix0: _Numbers, matrix1: _Numbers) -> bool:
    """Return whether two matrices are the same but for a factor."""
    first, second = (np.array(each, dtype=float) for each in (matrix0, matrix1))
    return bool(np.allclose(first / first[3, 3], second / second[3, 3]))


def _matrix(rotation: Rotation, translation: _Numbers = (0, 0, 0)) -> _Array:
    found = np.eye(4)
    found[:3, :3] = rotation.as_matrix()
    found[:3, 3] = np.array(translation, dtype=float)[:3]
    return found


def _rotation(quaternion: _Numbers) -> Rotation:
    values = np.array(quaternion, dtype=float)
    return Rotation.from_quat(values) if values @ values > np.finfo(float).eps else Rotation.identity()


def _about(angle: float, axis: _Numbers) -> Rotation:
    return Rotation.from_rotvec(angle * unit_vector(np.array(axis, dtype=float)[:3]))


def _quaternion(rotation: Rotation) -> _Quaternion:
    x, y, z, w = rotation.as_quat()
    return x, y, z, w


def _sequence(axes: Any) -> str:
    """Return SciPy's name of axes: small letters for those that stay, capital ones for those that turn along.

    Axes may also be four numbers: the first axis, whether the order is odd, whether the first is the last, too, and
    whether they turn along; of axes that turn along, they name the last one first.

    Raises:
        ValueError: If there are no such axes.
    """
    if not isinstance(axes, str):
        first, odd, repeated, turning = axes
        order = [first, (first + 1 + odd) % 3, first if repeated else (first + 2 - odd) % 3]
        axes = ("r" if turning else "s") + "".join("xyz"[index] for index in order[:: -1 if turning else 1])
    kind, names = axes[:1], axes[1:]
    if kind not in ("s", "r") or len(names) != 3 or not set(names) <= set("xyz"):
        raise ValueError(f"axes {axes!r} are not s or r and three of x, y, z, such as 'sxyz'")
    return str(names if kind == "s" else names.upper())


def _angles(rotation: Rotation, axes: Any) -> tuple[float, float, float]:
    with warnings.catch_warnings():  # where only a sum of two angles counts, the last one is zero, as in ROS
        warnings.simplefilter("ignore", UserWarning)
        first, second, third = rotation.as_euler(_sequence(axes))
    return first, second, third


def _put(found: Any, out: np.ndarray | None) -> Any:
    if out is not None:
        out[...] = found
    return found
