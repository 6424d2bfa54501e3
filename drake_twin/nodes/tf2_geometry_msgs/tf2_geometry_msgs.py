"""Stand-in for ``tf2_geometry_msgs``: poses, points and vectors in other frames.

The ``transform`` of a buffer knows these types after an import of it.
"""

from typing import Any

import numpy as np

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rigid_motion import Quaternion, Vector, add, multiply, normalized, rotate
from drake_twin.nodes.tf2_ros.buffer_interface import ConvertRegistration, TransformRegistration

__all__ = [
    "do_transform_point",
    "do_transform_polygon_stamped",
    "do_transform_pose",
    "do_transform_pose_stamped",
    "do_transform_pose_with_covariance_stamped",
    "do_transform_vector3",
    "from_msg_msg",
    "to_msg_msg",
    "transform_covariance",
]

_Stamped = Any  # a message with a header


def to_msg_msg(msg: Any) -> Any:
    """Return a message."""
    return msg


from_msg_msg = to_msg_msg


def transform_covariance(cov_in: Any, transform: Any) -> Any:
    """Return the covariance of a pose (36 numbers, row by row) in another frame."""
    turn = np.array([rotate(_rotation(transform), axis) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]).T
    both = np.kron(np.eye(2), turn)
    return (both @ np.reshape(cov_in, (6, 6)) @ both.T).reshape(36)


def do_transform_point(point: _Stamped, transform: Any) -> Any:
    """Return a ``PointStamped`` in another frame."""
    found = _like(point, transform)
    found.point.x, found.point.y, found.point.z = _moved(_xyz(point.point), transform)
    return found


def do_transform_vector3(vector3: _Stamped, transform: Any) -> Any:
    """Return a ``Vector3Stamped`` in another frame: it is only rotated."""
    found = _like(vector3, transform)
    found.vector.x, found.vector.y, found.vector.z = rotate(_rotation(transform), _xyz(vector3.vector))
    return found


def do_transform_pose(pose: Any, transform: Any) -> Any:
    """Return a ``Pose`` in another frame."""
    found = type(pose)()
    found.position.x, found.position.y, found.position.z = _moved(_xyz(pose.position), transform)
    turned = found.orientation
    turned.x, turned.y, turned.z, turned.w = normalized(multiply(_rotation(transform), _xyzw(pose.orientation)))
    return found


def do_transform_pose_stamped(pose: _Stamped, transform: Any) -> Any:
    """Return a ``PoseStamped`` in another frame."""
    found = _like(pose, transform)
    found.pose = do_transform_pose(pose.pose, transform)
    return found


def do_transform_pose_with_covariance_stamped(pose: _Stamped, transform: Any) -> Any:
    """Return a ``PoseWithCovarianceStamped`` in another frame."""
    found = _like(pose, transform)
    found.pose.pose = do_transform_pose(pose.pose.pose, transform)
    found.pose.covariance = transform_covariance(pose.pose.covariance, transform)
    return found


def do_transform_polygon_stamped(polygon: _Stamped, transform: Any) -> Any:
    """Return a ``PolygonStamped`` in another frame."""
    found = _like(polygon, transform)
    for point in polygon.polygon.points:
        x, y, z = _moved(_xyz(point), transform)
        found.polygon.points.append(type(point)(x=x, y=y, z=z))
    return found


def _like(message: _Stamped, transform: Any) -> Any:
    """Return an empty message of the same type with the header of a transform."""
    found = type(message)()
    found.header = transform.header
    return found


def _xyz(vector: Any) -> Vector:
    return vector.x, vector.y, vector.z


def _xyzw(rotation: Any) -> Quaternion:
    return rotation.x, rotation.y, rotation.z, rotation.w


def _rotation(transform: Any) -> Quaternion:
    return normalized(_xyzw(transform.transform.rotation))


def _moved(point: Vector, transform: Any) -> Vector:
    return add(rotate(_rotation(transform), point), _xyz(transform.transform.translation))


for _name, _function in {
    "PointStamped": do_transform_point,
    "Vector3Stamped": do_transform_vector3,
    "PoseStamped": do_transform_pose_stamped,
    "PoseWithCovarianceStamped": do_transform_pose_with_covariance_stamped,
    "PolygonStamped": do_transform_polygon_stamped,
}.items():
    _kind = message_class(f"geometry_msgs/msg/{_name}")
    TransformRegistration().add(_kind, _function)
    ConvertRegistration().add_to_msg(_kind, to_msg_msg)
    ConvertRegistration().add_from_msg(_kind, from_msg_msg)
