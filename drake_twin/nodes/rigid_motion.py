"""Rotations and translations as tf2 computes with them: quaternions (x, y, z, w) and vectors as tuples of numbers."""

from math import acos, fsum, sin, sqrt

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

IDENTITY: Quaternion = (0.0, 0.0, 0.0, 1.0)


def multiply(one: Quaternion, other: Quaternion) -> Quaternion:
    """Return the rotation that does the other one first."""
    x, y, z, w = one
    a, b, c, d = other
    return (
        w * a + x * d + y * c - z * b,
        w * b + y * d + z * a - x * c,
        w * c + z * d + x * b - y * a,
        w * d - x * a - y * b - z * c,
    )


def inverse(rotation: Quaternion) -> Quaternion:
    """Return the inverse of a rotation, whose quaternion is normalized."""
    x, y, z, w = rotation
    return -x, -y, -z, w


def rotate(rotation: Quaternion, vector: Vector) -> Vector:
    """Return a rotated vector; the quaternion is normalized."""
    x, y, z, w = rotation
    a, b, c = vector
    # twice the cross product of the axis and the vector
    u, v, t = 2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)
    return a + w * u + y * t - z * v, b + w * v + z * u - x * t, c + w * t + x * v - y * u


def add(one: Vector, other: Vector) -> Vector:
    """Return the sum of two vectors."""
    return one[0] + other[0], one[1] + other[1], one[2] + other[2]


def normalized(rotation: Quaternion) -> Quaternion:
    """Return a quaternion of length one, with the sign that tf2 has after its way over a matrix.

    Its w is positive where it is above a half, otherwise the greatest of x, y and z is.
    """
    x, y, z, w = rotation
    length = sqrt(x * x + y * y + z * z + w * w)
    leading = w if 4 * w * w > length * length else max(rotation[:3], key=abs)
    if leading < 0:
        length = -length
    return x / length, y / length, z / length, w / length


def interpolated(one: Quaternion, other: Quaternion, ratio: float) -> Quaternion:
    """Return the rotation between two others on the shortest path; zero is the first, one the second."""
    cosine = fsum(a * b for a, b in zip(one, other, strict=True))
    if cosine < 0:
        other, cosine = (-other[0], -other[1], -other[2], -other[3]), -cosine
    angle = acos(min(cosine, 1.0))
    if angle == 0:
        return one
    first, second = sin((1 - ratio) * angle) / sin(angle), sin(ratio * angle) / sin(angle)
    x, y, z, w = (a * first + b * second for a, b in zip(one, other, strict=True))
    return x, y, z, w
