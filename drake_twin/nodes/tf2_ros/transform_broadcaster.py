"""Stand-in for ``tf2_ros.transform_broadcaster``."""

from typing import Any

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy.qos import QoSProfile

__all__ = ["TransformBroadcaster"]


class TransformBroadcaster:
    """Publishes transforms on ``/tf``.

    Args:
        node: Publishes them.
        qos: The profile, or the depth, of the publisher.
    """

    def __init__(self, node: Any, qos: Any = None):
        self._kind = message_class("tf2_msgs/msg/TFMessage")
        self.pub_tf = node.create_publisher(self._kind, "/tf", QoSProfile(depth=100) if qos is None else qos)

    def sendTransform(self, transform: Any) -> None:
        """Publish a ``TransformStamped``, or several."""
        self.pub_tf.publish(self._kind(transforms=as_list(transform)))


def as_list(transform: Any) -> list[Any]:
    """Return one transform or several as a list."""
    return [*transform] if hasattr(transform, "__iter__") else [transform]
