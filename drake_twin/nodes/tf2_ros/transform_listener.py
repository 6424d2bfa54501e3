"""Stand-in for ``tf2_ros.transform_listener``."""

from threading import Thread
from typing import Any

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy.callback_groups import ReentrantCallbackGroup
from drake_twin.nodes.rclpy.executors import SingleThreadedExecutor
from drake_twin.nodes.rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from drake_twin.nodes.task import present_task

__all__ = ["TransformListener"]

_AUTHORITY = "default_authority"


class TransformListener:
    """Puts what comes on ``/tf`` and ``/tf_static`` into a buffer.

    Args:
        buffer: The buffer.
        node: Subscribes to the topics.
        spin_thread: Whether a thread of its own spins the node.
        qos: The profile, or the depth, of the subscription to ``/tf``.
        static_qos: That of the subscription to ``/tf_static``.
    """

    def __init__(self, buffer: Any, node: Any, *, spin_thread: bool = False, qos: Any = None, static_qos: Any = None):
        kept = HistoryPolicy.KEEP_LAST
        if qos is None:
            qos = QoSProfile(depth=100, durability=DurabilityPolicy.VOLATILE, history=kept)
        if static_qos is None:
            static_qos = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL, history=kept)
        self.buffer, self.node = buffer, node
        # So that a callback of the node can wait for a transform.
        self.group = ReentrantCallbackGroup()
        kind = message_class("tf2_msgs/msg/TFMessage")
        self.tf_sub = node.create_subscription(kind, "/tf", self.callback, qos, callback_group=self.group)
        self.tf_static_sub = node.create_subscription(
            kind, "/tf_static", self.static_callback, static_qos, callback_group=self.group
        )
        if spin_thread:
            self.executor = SingleThreadedExecutor()
            self.dedicated_listener_thread = Thread(target=self._spin)
            self.dedicated_listener_thread.start()
            # As in ROS, where the thread is quicker than what the program does next: a spin of its own takes the node.
            present_task().wait(lambda: node.executor is self.executor)

    def __del__(self) -> None:
        if hasattr(self, "dedicated_listener_thread"):
            self.executor.shutdown()
            self.dedicated_listener_thread.join()
        self.unregister()

    def unregister(self) -> None:
        """Subscribe to nothing any more."""
        for name in ("tf_sub", "tf_static_sub"):
            if hasattr(self, name):
                self.node.destroy_subscription(getattr(self, name))

    def callback(self, data: Any) -> None:
        """Take transforms."""
        for transform in data.transforms:
            self.buffer.set_transform(transform, _AUTHORITY)

    def static_callback(self, data: Any) -> None:
        """Take transforms that hold at all times."""
        for transform in data.transforms:
            self.buffer.set_transform_static(transform, _AUTHORITY)

    def _spin(self) -> None:
        self.executor.add_node(self.node)
        self.executor.spin()
        self.executor.remove_node(self.node)
