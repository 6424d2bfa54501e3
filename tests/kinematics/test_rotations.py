import numpy as np
from pydrake.math import RollPitchYaw, RotationMatrix

from drake_twin.kinematics.rotations import along_heading, heading_of, quaternion_from_rpy, quaternion_product, rotated

RNG = np.random.default_rng(1)
RPY = RNG.uniform(-np.pi, np.pi, (50, 3))
VECTORS = RNG.normal(size=(50, 3))


def drake_rotations(rpy):
    return [RotationMatrix(RollPitchYaw(*row)) for row in rpy]


def test_roll_pitch_yaw_means_what_drake_means_by_it():
    for quaternion, expected in zip(quaternion_from_rpy(RPY), drake_rotations(RPY), strict=True):
        wxyz = expected.ToQuaternion().wxyz()
        assert min(np.abs(quaternion - wxyz).max(), np.abs(quaternion + wxyz).max()) < 1e-12


def test_products_chain_rotations_as_drake_does():
    other = RPY[::-1]
    products = quaternion_product(quaternion_from_rpy(RPY), quaternion_from_rpy(other))
    for quaternion, a, b in zip(products, drake_rotations(RPY), drake_rotations(other), strict=True):
        wxyz = (a @ b).ToQuaternion().wxyz()
        assert min(np.abs(quaternion - wxyz).max(), np.abs(quaternion + wxyz).max()) < 1e-12


def test_vectors_are_turned_as_drake_turns_them():
    turned = rotated(quaternion_from_rpy(RPY), VECTORS)
    for row, rotation, vector in zip(turned, drake_rotations(RPY), VECTORS, strict=True):
        assert np.abs(row - rotation @ vector).max() < 1e-12


def test_the_heading_is_drakes_yaw_however_a_body_leans():
    for rotation in drake_rotations(RPY):
        assert abs(heading_of(*rotation.ToQuaternion().wxyz()) - RollPitchYaw(rotation).yaw_angle()) < 1e-9


def test_forwards_and_to_the_left_are_the_axes_of_a_body_that_is_turned():
    for heading, (x, y, _) in zip(RPY[:, 2], VECTORS, strict=True):
        forwards, left = RotationMatrix.MakeZRotation(heading).inverse().multiply([x, y, 0])[:2]
        assert np.abs(np.subtract(along_heading(heading, x, y), (forwards, left))).max() < 1e-12
