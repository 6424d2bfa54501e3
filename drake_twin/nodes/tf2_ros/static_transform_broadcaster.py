"""Stand-in for ``tf2_ros.static_transform_broadcaster``."""

from typing import Any

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from drake_twin.nodes.tf2_ros.transform_broadcaster import as_list

__all__ = ["StaticTransformBroadcaster"]


class StaticTransformBroadcaster:
    """Publishes transforms on ``/tf_static``, each time with all that it has published before.

    Args:
        node: Publishes them.
        qos: The profile, or the depth, of the publisher.
    """

    def __init__(self, node: Any, qos: Any = None):
        if qos is None:
            lasting = DurabilityPolicy.TRANSIENT_LOCAL
            qos = QoSProfile(depth=1, durability=lasting, history=HistoryPolicy.KEEP_LAST)
        kind = message_class("tf2_msgs/msg/TFMessage")
        self.pub_tf = node.create_publisher(kind, "/tf_static", qos)
        self.net_message = kind()
        self._child_frame_ids: set[str] = set()

    def sendTransform(self, transform: Any) -> None:
        """Publish a ``TransformStamped``, or several; of each child frame the first one counts, as in Jazzy."""
        for each in as_list(transform):
            if each.child_frame_id not in self._child_frame_ids:
                self._child_frame_ids.add(each.child_frame_id)
                self.net_message.transforms.append(each)
        self.pub_tf.publish(self.net_message)
