"""Euler angles, quaternions and matrices, with the numbers of upstream's tests.

Lines cited are those of test/test_transformations.py of DLu/tf_transformations (branch main).
"""

import math
from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from drake_twin.ros2 import tf_transformations as stand_in

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
AXES = [
    kind + "".join(axes)
    for kind in "sr"
    for axes in product("xyz", repeat=3)
    if axes[0] != axes[1] and axes[1] != axes[2]
]


@pytest.fixture
def random():
    return np.random.default_rng(5)


def test_standard():  # :56-78
    alpha, beta, gamma = 0.123, -1.234, 2.345
    turns = [stand_in.rotation_matrix(*each) for each in ((alpha, X), (beta, Y), (gamma, Z))]
    turn = stand_in.concatenate_matrices(*turns)
    assert np.allclose([alpha, beta, gamma], stand_in.euler_from_matrix(turn, "rxyz"))
    assert stand_in.is_same_transform(turn, stand_in.euler_matrix(alpha, beta, gamma, "rxyz"))
    quaternions = [stand_in.quaternion_about_axis(*each) for each in ((alpha, X), (beta, Y), (gamma, Z))]
    both = stand_in.quaternion_multiply(quaternions[0], quaternions[1])
    all_three = stand_in.quaternion_multiply(both, quaternions[2])
    assert stand_in.is_same_transform(turn, stand_in.quaternion_matrix(all_three))


def test_translations(random):  # :98-114
    assert np.array_equal(stand_in.identity_matrix(), np.eye(4))
    values = random.normal(size=3)
    assert np.allclose(values, stand_in.translation_matrix(values)[:3, 3])
    assert np.allclose(values, stand_in.translation_from_matrix(stand_in.translation_matrix(values)))


def test_rotations_about_points(random):  # :140-163
    angle, direction, point = 2.1, *random.normal(size=(2, 3))
    turn = stand_in.rotation_matrix(angle, direction, point)
    assert stand_in.is_same_transform(turn, stand_in.rotation_matrix(angle - 2 * math.pi, direction, point))
    assert stand_in.is_same_transform(turn, stand_in.rotation_matrix(-angle, -direction, point))
    assert np.allclose(np.eye(4), stand_in.rotation_matrix(math.pi * 2, direction))
    assert np.allclose(2.0, np.trace(stand_in.rotation_matrix(math.pi / 2, direction, point)))
    assert stand_in.is_same_transform(turn, stand_in.rotation_matrix(*stand_in.rotation_from_matrix(turn)))


def test_euler_matrices():  # :336-340
    assert np.allclose(np.sum(stand_in.euler_matrix(1, 2, 3, "syxz")[0]), -1.34786452)
    assert np.allclose(np.sum(stand_in.euler_matrix(1, 2, 3, (0, 1, 0, 1))[0]), -0.383436184)


@pytest.mark.parametrize("axes", AXES)
def test_all_axes(axes, random):  # :343-352
    angles = 4 * math.pi * (random.random(3) - 0.5)
    turn = stand_in.euler_matrix(*angles, axes=axes)
    assert np.allclose(turn, stand_in.euler_matrix(*stand_in.euler_from_matrix(turn, axes), axes=axes))


def test_numbers_of_quaternions():  # :355-383
    assert np.allclose(stand_in.euler_from_quaternion([0.06146124, 0, 0, 0.99810947]), [0.123, 0, 0])
    found = stand_in.quaternion_from_euler(1, 2, 3, "ryxz")
    assert np.allclose(found, [0.310622, -0.718287, 0.444435, 0.435953])
    assert np.allclose(stand_in.quaternion_about_axis(0.123, X), [0.06146124, 0, 0, 0.99810947])
    turn = stand_in.quaternion_matrix([0.06146124, 0, 0, 0.99810947])
    assert np.allclose(turn, stand_in.rotation_matrix(0.123, X))
    found = stand_in.quaternion_from_matrix(stand_in.rotation_matrix(0.123, (1, 2, 3)))
    assert np.allclose(found, [0.0164262, 0.0328524, 0.0492786, 0.9981095])
    assert np.allclose(stand_in.quaternion_multiply([1, -2, 3, 4], [-5, 6, 7, 8]), [-44, -14, 48, 28])


def test_conjugates_and_inverses():  # :386-395
    one = stand_in.random_quaternion()
    other = stand_in.quaternion_conjugate(one)
    assert other[3] == one[3]
    assert all(other[:3] == -one[:3])
    product_ = stand_in.quaternion_multiply(3 * one, stand_in.quaternion_inverse(3 * one))
    assert np.allclose(product_, [0, 0, 0, 1])


@pytest.mark.parametrize("fraction", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("sign", [1, -1])
def test_slerp_is_scipys(random, fraction, sign):
    one, other = Rotation.random(2, rng=random)
    found = stand_in.quaternion_slerp(one.as_quat(), sign * other.as_quat(), fraction)
    expected = Slerp([0, 1], Rotation.concatenate([one, other]))(fraction)
    assert (Rotation.from_quat(found) * expected.inv()).magnitude() < 1e-12


def test_what_messages_take():
    """The parts are numbers that a float64 field takes; the sign is that of half angles, as in transforms3d."""
    found = stand_in.quaternion_from_euler(0, 0, 1.5 * math.pi)
    assert isinstance(found, tuple)
    assert all(isinstance(part, float) for part in found)
    assert found == pytest.approx((0, 0, math.sin(0.75 * math.pi), math.cos(0.75 * math.pi)))
    assert all(isinstance(part, float) for part in stand_in.euler_from_quaternion(found))
    assert stand_in.euler_from_quaternion((0, 0, 0, 0)) == (0, 0, 0)


def test_gimbal_lock(recwarn):
    """Where only a sum of two angles counts, the last one is zero (transforms3d.euler.mat2euler), without a warning."""
    found = stand_in.euler_from_matrix(stand_in.euler_matrix(0.3, math.pi / 2, 0.1))
    assert np.allclose(found, (0.2, math.pi / 2, 0), atol=1e-7)
    assert not recwarn.list


def test_lengths(random):
    values = random.normal(size=(4, 3))
    assert np.allclose(stand_in.vector_norm(values, axis=1), np.linalg.norm(values, axis=1))
    assert np.allclose(stand_in.vector_norm(stand_in.unit_vector(values, axis=1), axis=1), 1)
    assert stand_in.unit_vector((0, 0, 0)).tolist() == [0, 0, 0]
    out = np.empty(3)
    stand_in.unit_vector(values[0], out=out)
    assert np.allclose(out, values[0] / np.linalg.norm(values[0]))


def test_axes_that_do_not_exist():
    for axes in ("xyz", "sxy", "qxyz", "sxya"):
        with pytest.raises(ValueError, match="are not s or r and three of x, y, z"):
            stand_in.euler_matrix(1, 2, 3, axes)
