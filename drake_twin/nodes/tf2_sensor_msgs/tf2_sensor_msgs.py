"""Stand-in for ``tf2_sensor_msgs.tf2_sensor_msgs``: point clouds in other frames.

The ``transform`` of a buffer knows ``PointCloud2`` after an import of it.
"""

from typing import Any

import numpy as np
from numpy.lib.recfunctions import structured_to_unstructured

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rigid_motion import normalized, rotate
from drake_twin.nodes.sensor_msgs_py.point_cloud2 import PointCloud2, create_cloud, read_points
from drake_twin.nodes.tf2_geometry_msgs import from_msg_msg, to_msg_msg
from drake_twin.nodes.tf2_ros.buffer_interface import ConvertRegistration, TransformRegistration

__all__ = ["do_transform_cloud", "from_msg_msg", "to_msg_msg", "transform_points"]

_Header: Any = message_class("std_msgs/msg/Header")
_AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def transform_points(point_cloud: np.ndarray, transform: Any) -> np.ndarray:
    """Return points in another frame.

    Args:
        point_cloud: The points (m), shape (n, 3).
        transform: A ``geometry_msgs/msg/Transform``; a quaternion of zeros rotates nothing.
    """
    turn, shift = transform.rotation, transform.translation
    quaternion = turn.x, turn.y, turn.z, turn.w
    axes = [rotate(normalized(quaternion), axis) for axis in _AXES] if any(quaternion) else _AXES
    moved: np.ndarray = point_cloud @ np.array(axes) + np.array([shift.x, shift.y, shift.z])
    return moved


def do_transform_cloud(cloud: Any, transform: Any) -> Any:
    """Return a ``PointCloud2`` with its x, y and z in another frame, and its other fields as they are.

    Args:
        cloud: The cloud, which stays as it is.
        transform: A ``TransformStamped``, whose frame the cloud is in then; or a ``Transform``.
    """
    header = _Header(stamp=cloud.header.stamp, frame_id=cloud.header.frame_id)
    if hasattr(transform, "transform"):
        header.frame_id, transform = transform.header.frame_id, transform.transform
    assert {*"xyz"} <= {field.name for field in cloud.fields}, "the cloud has no fields x, y and z"
    points = read_points(cloud).copy()
    moved = transform_points(structured_to_unstructured(points[[*"xyz"]]), transform)
    points["x"], points["y"], points["z"] = moved.T
    return create_cloud(header, cloud.fields, points, cloud.point_step)


TransformRegistration().add(PointCloud2, do_transform_cloud)
ConvertRegistration().add_to_msg(PointCloud2, to_msg_msg)
ConvertRegistration().add_from_msg(PointCloud2, from_msg_msg)
