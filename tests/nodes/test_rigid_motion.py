"""Rotations and translations of tf2, against SciPy."""

from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from drake_twin.nodes.rigid_motion import IDENTITY, add, interpolated, inverse, multiply, normalized, rotate


@pytest.fixture(params=range(5))
def two(request):
    """Two rotations: SciPy's, and their quaternions."""
    both = Rotation.random(2, rng=np.random.default_rng(request.param))
    return both, tuple(map(tuple, both.as_quat().tolist()))


def same(quaternion, rotation):
    """Whether a quaternion, of either sign, is a rotation."""
    return abs(np.dot(quaternion, rotation.as_quat())) == pytest.approx(1.0, abs=1e-14)


def test_products_inverses_and_turned_vectors(two):
    both, (one, other) = two
    assert same(multiply(one, other), both[0] * both[1])
    assert same(inverse(one), both[0].inv())
    vector = (0.3, -2.0, 1.5)
    assert rotate(one, vector) == pytest.approx(both[0].apply(vector), abs=1e-14)
    assert add(vector, (1.0, 2.0, 3.0)) == pytest.approx((1.3, 0.0, 4.5))
    assert multiply(IDENTITY, one) == one
    assert rotate(IDENTITY, vector) == vector


@pytest.mark.parametrize("ratio", [0.0, 0.2, 0.5, 0.9, 1.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_between_two_rotations_is_the_shortest_path(two, ratio, sign):
    both, (one, other) = two
    found = interpolated(one, tuple(sign * value for value in other), ratio)
    assert same(found, Slerp([0, 1], both)(ratio))


def test_between_a_rotation_and_itself_there_is_nothing():
    turned = (0.0, 0.0, sin(0.3), cos(0.3))
    assert interpolated(turned, turned, 0.7) == turned
    third = interpolated(IDENTITY, (0.0, 0.0, 1.0, 0.0), 1 / 3)  # of half a turn
    assert third == pytest.approx((0.0, 0.0, sin(pi / 6), cos(pi / 6)))


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ((0.0, 0.0, 0.0, 2.0), (0.0, 0.0, 0.0, 1.0)),
        ((0.0, 0.0, 0.0, -2.0), (0.0, 0.0, 0.0, 1.0)),
        ((1.0, 0.0, 0.0, 1.0), (sqrt(0.5), 0.0, 0.0, sqrt(0.5))),
        ((-1.0, 0.0, 0.0, -1.0), (sqrt(0.5), 0.0, 0.0, sqrt(0.5))),
        ((0.0, -3.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0)),
        ((1.0, -2.0, 0.0, 0.5), (-1 / sqrt(5.25), 2 / sqrt(5.25), 0.0, -0.5 / sqrt(5.25))),  # y is the greatest
    ],
)
def test_a_normalized_quaternion_has_the_sign_of_tf2(given, expected):
    assert normalized(given) == pytest.approx(expected, abs=1e-15)
