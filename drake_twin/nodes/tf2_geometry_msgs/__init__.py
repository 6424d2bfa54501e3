"""Stand-in for ``tf2_geometry_msgs``: poses, points and vectors in other frames.

Its module exports the messages that it imports, too.
"""

from typing import Any

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.tf2_geometry_msgs.tf2_geometry_msgs import (
    do_transform_point,
    do_transform_polygon_stamped,
    do_transform_pose,
    do_transform_pose_stamped,
    do_transform_pose_with_covariance_stamped,
    do_transform_vector3,
    from_msg_msg,
    to_msg_msg,
    transform_covariance,
)

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

_MESSAGES = frozenset(
    (
        "Point",
        "Point32",
        "PointStamped",
        "PolygonStamped",
        "Pose",
        "PoseStamped",
        "PoseWithCovarianceStamped",
        "TransformStamped",
        "Vector3Stamped",
    )
)


def __getattr__(name: str) -> Any:
    if name in _MESSAGES:
        return message_class(f"geometry_msgs/msg/{name}")
    raise AttributeError(f"module 'tf2_geometry_msgs' has no attribute {name!r}")
