"""Stand-in for ``rclpy.publisher``."""

from collections import deque
from operator import attrgetter
from typing import Any

from drake_twin.nodes import message_classes
from drake_twin.nodes.graph import Graph
from drake_twin.nodes.graph_items import Publication
from drake_twin.nodes.rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from drake_twin.nodes.task import present_task


class Publisher:
    """Publishes messages of a type on a topic."""

    def __init__(self, graph: Graph, msg_type: Any, topic: str, qos_profile: QoSProfile, node: str):
        self.msg_type, self.topic, self.qos_profile = msg_type, topic, qos_profile
        self._topic_name = topic
        self._graph = graph
        depth = qos_profile.depth if qos_profile.durability is DurabilityPolicy.TRANSIENT_LOCAL else 0
        may_lose = qos_profile.reliability is ReliabilityPolicy.BEST_EFFORT
        kind, kept = message_classes.type_name(msg_type), deque[Any](maxlen=depth or None)
        self._publication = Publication(topic, kind, node, depth, kept, may_lose, qos_profile)
        graph.advertise(self._publication)
        present_task().program.belongings.append(self._publication)

    topic_name = property(attrgetter("_topic_name"))

    def publish(self, msg: Any) -> None:
        present_task()
        if isinstance(msg, bytes):
            from drake_twin.messages.interface_types import deserialize

            msg = message_classes.from_wire(self._publication.type, deserialize(self._publication.type, msg))
        if not isinstance(msg, self.msg_type):
            raise TypeError(f"Expected {self.msg_type}, got {type(msg)}")
        self._graph.publish(self._publication, msg)

    def get_subscription_count(self) -> int:
        present_task()
        return len(self._graph.subscribers_of(self.topic))

    def assert_liveliness(self) -> None:
        pass

    def wait_for_all_acked(self, timeout: Any = None) -> bool:
        return True

    def destroy(self) -> None:
        self._graph.withdraw(self._publication)
