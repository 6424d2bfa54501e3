"""Poses, points and vectors in other frames: against SciPy, and as upstream's test asserts it.

Lines cited are those of tf2_geometry_msgs/test/test_tf2_geometry_msgs.py (geometry2, branch jazzy).
"""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from drake_twin.nodes import tf2_geometry_msgs as stand_in
from drake_twin.nodes.message_classes import message_class

Quaternion = message_class("geometry_msgs/msg/Quaternion")


def made(name, **values):
    return message_class(f"geometry_msgs/msg/{name}")(**values)


def put(message, values):
    for name, value in zip("xyzw", values, strict=False):
        setattr(message, name, float(value))


def got(message):
    return [getattr(message, name) for name in "xyzw" if hasattr(message, name)]


def transform(translation, rotation):
    found = made("TransformStamped", child_frame_id="b")
    found.header.frame_id = "a"
    found.header.stamp.sec = 7
    put(found.transform.translation, translation)
    put(found.transform.rotation, rotation)
    return found


@pytest.fixture(params=range(4))
def case(request):
    """A transform, SciPy's rotation and translation of it, and a point."""
    generator = np.random.default_rng(request.param)
    rotation, translation, point = Rotation.random(rng=generator), *generator.normal(size=(2, 3))
    return transform(translation, rotation.as_quat()), rotation, translation, point


def test_points_and_vectors(case):
    found, rotation, translation, values = case
    point, vector = made("PointStamped"), made("Vector3Stamped")
    put(point.point, values)
    put(vector.vector, values)
    moved = stand_in.do_transform_point(point, found)
    np.testing.assert_allclose(got(moved.point), rotation.apply(values) + translation, atol=1e-14)
    assert moved.header == found.header
    np.testing.assert_allclose(
        got(stand_in.do_transform_vector3(vector, found).vector), rotation.apply(values), atol=1e-14
    )
    polygon = made("PolygonStamped")
    polygon.polygon.points = [made("Point32", x=1.0, y=2.0, z=3.0)]
    (corner,) = stand_in.do_transform_polygon_stamped(polygon, found).polygon.points
    np.testing.assert_allclose(got(corner), rotation.apply([1, 2, 3]) + translation, atol=1e-14)


def test_poses(case):
    found, rotation, translation, values = case
    own = Rotation.from_euler("xyz", values)
    pose = made("PoseStamped")
    put(pose.pose.position, values)
    put(pose.pose.orientation, own.as_quat())
    moved = stand_in.do_transform_pose_stamped(pose, found)
    np.testing.assert_allclose(got(moved.pose.position), rotation.apply(values) + translation, atol=1e-14)
    np.testing.assert_allclose(
        got(moved.pose.orientation), (rotation * own).as_quat(canonical=True) * sign(moved), atol=1e-14
    )
    assert moved.header == found.header
    assert stand_in.do_transform_pose(pose.pose, found) == moved.pose


def sign(moved):
    """A quaternion and its negative are the same rotation."""
    return 1 if moved.pose.orientation.w >= 0 else -1


def test_covariances(case):
    found, rotation, _, _ = case
    root = np.random.default_rng(1).normal(size=(6, 6))
    covariance = root @ root.T
    both = np.zeros((6, 6))
    both[:3, :3] = both[3:, 3:] = rotation.as_matrix()
    moved = stand_in.transform_covariance(covariance.reshape(36), found)
    np.testing.assert_allclose(moved.reshape(6, 6), both @ covariance @ both.T, atol=1e-13)


def test_vectors_are_only_rotated():  # :105-134
    vector = made("Vector3Stamped")
    vector.vector.x = 1.0
    assert got(stand_in.do_transform_vector3(vector, transform((1, 2, 3), (0, 0, 0, 1))).vector) == [1, 0, 0]
    assert got(stand_in.do_transform_vector3(vector, transform((1, 2, 3), (0, 1, 0, 0))).vector) == [-1, 0, 0]


def test_a_pose_with_covariance():  # :137-175
    pose = made("PoseWithCovarianceStamped")
    pose.pose.covariance = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0) * 6
    put(pose.pose.pose.position, (1, 2, 3))
    pose.pose.pose.orientation = Quaternion(x=1.0, w=0.0)
    moved = stand_in.do_transform_pose_with_covariance_stamped(pose, transform((1, 2, 3), (1, 0, 0, 0)))
    assert got(moved.pose.pose.position) == [2, 0, 0]
    assert got(moved.pose.pose.orientation) in ([0, 0, 0, 1], [0, 0, 0, -1])
    first, second = [1, -2, -3, 4, -5, -6], [-1, 2, 3, -4, 5, 6]
    expected = [*first, *second, *second, *first, *second, *second]
    np.testing.assert_array_equal(moved.pose.covariance, expected)
