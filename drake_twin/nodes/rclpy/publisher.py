"""Stand-in for ``rclpy.publisher``."""

from collections import deque
from typing import Any, TypeVar

from drake_twin.nodes import message_classes
from drake_twin.nodes.graph_items import Publication
from drake_twin.nodes.graph_lists import count_matched
from drake_twin.nodes.pace import Pace
from drake_twin.nodes.rclpy.event_handler import PublisherEventCallbacks
from drake_twin.nodes.rclpy.handle import Handle
from drake_twin.nodes.rclpy.node_handle import NodeHandle
from drake_twin.nodes.rclpy.qos_profiles import DurabilityPolicy, QoSProfile, ReliabilityPolicy, queue_size
from drake_twin.nodes.task import present_task

MsgType = TypeVar("MsgType")


class PublisherHandle(Handle):
    """What a publisher is on the graph.

    Args:
        node: Its node.
        msg_type: The class of its messages.
        topic: Its full name.
        profile: Its quality of service.

    Attributes:
        graph: The graph.
        item: What it has on the graph.
        pace: What slows loops down.
    """

    def __init__(self, node: NodeHandle, msg_type: Any, topic: str, profile: QoSProfile):
        super().__init__(lambda: node.graph.withdraw(self.item), topic, node.logger_name)
        self.add_waitable = node.add_waitable
        is_kept = profile.durability in (DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.BEST_AVAILABLE)
        depth = queue_size(profile) or 0 if is_kept else 0
        may_lose = profile.reliability is ReliabilityPolicy.BEST_EFFORT
        kind, kept = message_classes.type_name(msg_type), deque[Any](maxlen=depth or None)
        self.item = Publication(topic, kind, node.name, depth, kept, may_lose, profile)
        self.item.is_timed = bool(profile.deadline.nanoseconds or profile.liveliness_lease_duration.nanoseconds)
        self.graph = node.graph
        self.pace = Pace(lambda message: message_classes.from_wire(kind, message_classes.to_wire(message)))

    def advertise(self) -> None:
        """Let it be on the graph, until it is destroyed or its program ends."""
        self.graph.advertise(self.item)
        self.graph.quality.asserted(self.item)  # its lease begins
        present_task().program.belongings.append(self.item)

    def publish(self, message: Any) -> None:
        """Publish a message."""
        self.graph.publish(self.item, message)


class Publisher:
    """Publishes messages of a type on a topic."""

    def __init__(
        self,
        publisher_impl: Any,
        msg_type: Any,
        topic: str,
        qos_profile: QoSProfile,
        event_callbacks: Any,
        callback_group: Any,
    ):
        self._impl: PublisherHandle = publisher_impl
        self.msg_type, self.topic, self.qos_profile = msg_type, topic, qos_profile
        callbacks = event_callbacks or PublisherEventCallbacks()
        self.event_handlers: list[Any] = callbacks.create_event_handlers(callback_group, publisher_impl, topic)
        publisher_impl.advertise()

    handle = property(lambda self: self._impl)

    @property
    def topic_name(self) -> str:
        self._impl.check()
        return self._impl.name

    def publish(self, msg: Any) -> None:
        task = present_task()
        self._impl.check()
        if isinstance(msg, bytes):
            from drake_twin.messages.interface_types import deserialize

            msg = message_classes.from_wire(self._impl.item.type, deserialize(self._impl.item.type, msg))
        if not isinstance(msg, self.msg_type):
            raise TypeError(f"Expected {self.msg_type}, got {type(msg)}")
        self._impl.graph.publish(self._impl.item, msg)
        self._impl.pace.keep(msg, task)

    def get_subscription_count(self) -> int:
        present_task()
        self._impl.check()
        return count_matched(self._impl.item)

    def assert_liveliness(self) -> None:
        self._impl.check()
        self._impl.graph.quality.asserted(self._impl.item)

    def wait_for_all_acked(self, timeout: Any = None) -> bool:
        self._impl.check()
        return True

    def destroy(self) -> None:
        for handler in self.event_handlers:
            handler.destroy()
        self._impl.destroy_when_not_in_use()
