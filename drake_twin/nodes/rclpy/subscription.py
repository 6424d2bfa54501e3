"""Stand-in for ``rclpy.subscription``."""

import inspect
from collections import deque
from collections.abc import Callable
from enum import Enum
from operator import attrgetter
from typing import Any

from drake_twin.nodes import message_classes
from drake_twin.nodes.graph import Graph
from drake_twin.nodes.graph_items import Reception
from drake_twin.nodes.rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from drake_twin.nodes.task import Task, present_task


class Subscription:
    """Calls back with the messages of a topic."""

    class CallbackType(Enum):
        """What a callback takes."""

        MessageOnly = 0
        WithMessageInfo = 1

    def __init__(
        self,
        graph: Graph,
        msg_type: Any,
        topic: str,
        callback: Callable[..., Any],
        callback_group: Any,
        qos_profile: QoSProfile,
        raw: bool,
        node: str,
    ):
        self.msg_type, self.topic, self.callback = msg_type, topic, callback
        self.callback_group, self.qos_profile, self.raw = callback_group, qos_profile, raw
        self._topic_name = topic
        self._graph = graph
        self._task: Task = present_task()
        self._type = message_classes.type_name(msg_type)
        self._messages: deque[tuple[Any, int]] = deque(maxlen=qos_profile.queue_size)
        self._takes_info = _takes_two(callback)
        latched = qos_profile.durability is DurabilityPolicy.TRANSIENT_LOCAL
        may_lose = qos_profile.reliability in (ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.BEST_AVAILABLE)
        self._reception = Reception(
            topic, self._type, node, self._put, latched, is_best_effort=may_lose, profile=qos_profile
        )
        graph.subscribe(self._reception)
        self._task.program.belongings.append(self._reception)

    topic_name = property(attrgetter("_topic_name"))

    def _put(self, message: Any) -> None:
        self._messages.append((message, self._task.now))

    def is_ready(self) -> bool:
        return bool(self._messages)

    def execute(self) -> Any:
        message, time = self._messages.popleft()
        if self.raw:
            from drake_twin.messages.interface_types import serialize

            given: Any = serialize(message)
        else:
            given = message_classes.from_wire(self._type, message)
        if self._takes_info:
            return self.callback(given, {"source_timestamp": time, "received_timestamp": self._task.now})
        return self.callback(given)

    def get_publisher_count(self) -> int:
        present_task()
        return len(self._graph.publishers_of(self.topic))

    def destroy(self) -> None:
        self._messages.clear()
        self._graph.withdraw(self._reception)


def _takes_two(callback: Callable[..., Any]) -> bool:
    try:
        signature = inspect.signature(callback)
    except (TypeError, ValueError):
        return False
    try:
        signature.bind(None)
    except TypeError:
        try:
            signature.bind(None, None)
        except TypeError:
            return False
        return True
    return False
