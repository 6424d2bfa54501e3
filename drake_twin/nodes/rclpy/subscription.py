"""Stand-in for ``rclpy.subscription``."""

import inspect
from collections import deque
from collections.abc import Callable
from enum import Enum
from math import inf
from typing import Any, TypeVar

from drake_twin.nodes import message_classes
from drake_twin.nodes.graph_items import Reception
from drake_twin.nodes.graph_lists import count_matched
from drake_twin.nodes.rclpy.event_handler import SubscriptionEventCallbacks
from drake_twin.nodes.rclpy.handle import Handle
from drake_twin.nodes.rclpy.node_handle import NodeHandle
from drake_twin.nodes.rclpy.qos_profiles import DurabilityPolicy, QoSProfile, ReliabilityPolicy, queue_size
from drake_twin.nodes.task import Task, present_task

MsgType = TypeVar("MsgType")


class SubscriptionHandle(Handle):
    """What a subscription is on the graph.

    Args:
        node: Its node.
        msg_type: The class of its messages.
        topic: Its full name.
        profile: Its quality of service.

    Attributes:
        graph: The graph.
        item: What it has on the graph.
        messages: The messages that wait, each with the times (ns) of its arrival and its end.
    """

    def __init__(self, node: NodeHandle, msg_type: Any, topic: str, profile: QoSProfile):
        super().__init__(lambda: node.graph.withdraw(self.item), topic, node.logger_name)
        self.add_waitable = node.add_waitable
        self.messages: deque[tuple[Any, int, float]] = deque(maxlen=queue_size(profile))
        self.task: Task = present_task()
        latched = profile.durability in (DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.BEST_AVAILABLE)
        may_lose = profile.reliability in (ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.BEST_AVAILABLE)
        kind = message_classes.type_name(msg_type)
        options: Any = {"is_best_effort": may_lose, "profile": profile}
        self.item = Reception(topic, kind, node.name, self._put, latched, **options)
        self.item.is_timed = bool(profile.deadline.nanoseconds)
        self.graph = node.graph

    def _put(self, message: Any, expires: float = inf) -> None:
        if self.item.is_timed:
            self.graph.quality.passed(self.item)
        self.messages.append((message, self.task.now, expires))

    def subscribe(self) -> None:
        """Let it be on the graph, until it is destroyed or its program ends."""
        self.graph.subscribe(self.item)
        present_task().program.belongings.append(self.item)

    def _is_ready(self) -> bool:
        """Return whether a message waits that has not expired."""
        messages = self.messages
        while messages and messages[0][2] < self.task.now:
            messages.popleft()
        return bool(messages)

    def take_message(self, pymsg_type: Any, raw: bool) -> tuple[Any, dict[str, int]] | None:
        """Return the next message, or its bytes, and its times (ns); None without one."""
        self.check()
        if not self._is_ready():
            present_task().count_idle_call()
            return None
        message, time, _ = self.messages.popleft()
        return self.given(message, raw=raw), {"source_timestamp": time, "received_timestamp": self.task.now}

    def given(self, message: Any, *, raw: bool) -> Any:
        """Return a message as a callback gets it, or its bytes, which DDS pads to four of them."""
        if not raw:
            return message_classes.from_wire(self.item.type, message)
        from drake_twin.messages.interface_types import serialize

        data = serialize(message)
        return data + bytes(-len(data) % 4)


class Subscription:
    """Calls back with the messages of a topic."""

    class CallbackType(Enum):
        """What a callback takes."""

        MessageOnly = 0
        WithMessageInfo = 1

    def __init__(
        self,
        subscription_impl: Any,
        msg_type: Any,
        topic: str,
        callback: Callable[..., Any],
        callback_group: Any,
        qos_profile: QoSProfile,
        raw: bool,
        event_callbacks: Any,
    ):
        self._impl: SubscriptionHandle = subscription_impl
        self.msg_type, self.topic, self.callback_group = msg_type, topic, callback_group
        self.qos_profile, self.raw = qos_profile, raw
        self.callback = callback
        callbacks = event_callbacks or SubscriptionEventCallbacks()
        self.event_handlers: list[Any] = callbacks.create_event_handlers(callback_group, subscription_impl, topic)
        self._messages, self._task = subscription_impl.messages, subscription_impl.task
        subscription_impl.subscribe()

    handle = property(lambda self: self._impl)

    @property
    def topic_name(self) -> str:
        self._impl.check()
        return self._impl.name

    @property
    def callback(self) -> Callable[..., Any]:
        return self._callback

    @callback.setter
    def callback(self, value: Callable[..., Any]) -> None:
        self._callback_type = _type_of(value)
        self._callback = value

    def _is_ready(self) -> bool:
        messages = self._messages
        return bool(messages) and (messages[0][2] >= self._task.now or self._impl._is_ready())

    def _execute(self) -> Any:
        message, time, _ = self._messages.popleft()
        given = self._impl.given(message, raw=self.raw)
        if self._callback_type is Subscription.CallbackType.WithMessageInfo:
            return self._callback(given, {"source_timestamp": time, "received_timestamp": self._task.now})
        return self._callback(given)

    def get_publisher_count(self) -> int:
        present_task()
        self._impl.check()
        return count_matched(self._impl.item)

    def destroy(self) -> None:
        for handler in self.event_handlers:
            handler.destroy()
        self._impl.messages.clear()
        self._impl.destroy_when_not_in_use()


def _type_of(callback: Callable[..., Any]) -> Subscription.CallbackType:
    """Return whether a callback takes a message's times beside it.

    Raises:
        RuntimeError: If it takes neither one nor two arguments.
    """
    for count, found in enumerate(Subscription.CallbackType, 1):
        try:
            inspect.signature(callback).bind(*[None] * count)
        except TypeError:
            continue
        except ValueError:  # it has no signature
            return Subscription.CallbackType.MessageOnly
        return found
    text = "Subscription.__init__(): callback should be either be callable with one argument (to get only the message)"
    raise RuntimeError(f"{text} or two (to get message and message info)")
