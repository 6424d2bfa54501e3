"""Stand-in for ``rclpy.event_handler``: what publishers and subscriptions are told of their quality of service."""

import inspect
from collections.abc import Callable
from dataclasses import fields, make_dataclass
from functools import partial
from typing import Any

from drake_twin.nodes.rclpy._rclpy_pybind11 import UnsupportedEventTypeError as UnsupportedEventTypeError
from drake_twin.nodes.rclpy.logging import get_logger
from drake_twin.nodes.rclpy.native import native_enum, unreadable
from drake_twin.nodes.rclpy.qos_profiles import qos_policy_name_from_kind
from drake_twin.nodes.rclpy.waitable import GraphWaitable

QoSPublisherEventType = native_enum(
    "QoSPublisherEventType",
    "The events of publishers.",
    __name__,
    RCL_PUBLISHER_OFFERED_DEADLINE_MISSED=0,
    RCL_PUBLISHER_LIVELINESS_LOST=1,
    RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS=2,
    RCL_PUBLISHER_INCOMPATIBLE_TYPE=3,
    RCL_PUBLISHER_MATCHED=4,
)
QoSSubscriptionEventType = native_enum(
    "QoSSubscriptionEventType",
    "The events of subscriptions.",
    __name__,
    RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED=0,
    RCL_SUBSCRIPTION_LIVELINESS_CHANGED=1,
    RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS=2,
    RCL_SUBSCRIPTION_MESSAGE_LOST=3,
    RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE=4,
    RCL_SUBSCRIPTION_MATCHED=5,
)


def _status(name: str, *names: str) -> type:
    """Return the class of a status: counts, and how much each has changed since it was last told of."""
    changes = [f"{each}_change" for each in names if each.endswith("_count")]
    found = make_dataclass(name, [(each, int, 0) for each in (*names, *changes)], namespace={"__module__": __name__})
    unreadable(vars(found)["__init__"])
    return found


QoSRequestedDeadlineMissedInfo = _status("QoSRequestedDeadlineMissedInfo", "total_count")
QoSOfferedDeadlineMissedInfo = _status("QoSOfferedDeadlineMissedInfo", "total_count")
QoSLivelinessChangedInfo = _status("QoSLivelinessChangedInfo", "alive_count", "not_alive_count")
QoSLivelinessLostInfo = _status("QoSLivelinessLostInfo", "total_count")
QoSMessageLostInfo = _status("QoSMessageLostInfo", "total_count")
QoSRequestedIncompatibleQoSInfo = _status("QoSRequestedIncompatibleQoSInfo", "total_count", "last_policy_kind")
QoSOfferedIncompatibleQoSInfo = QoSRequestedIncompatibleQoSInfo
QoSSubscriptionMatchedInfo = _status("QoSSubscriptionMatchedInfo", "total_count", "current_count")
QoSPublisherMatchedInfo = QoSSubscriptionMatchedInfo
IncompatibleTypeInfo = _status("IncompatibleTypeInfo", "total_count")

# Event → its name where it is told of, and the class of its status.
_OF_PUBLISHERS = {
    QoSPublisherEventType.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED: ("deadline", QoSOfferedDeadlineMissedInfo),
    QoSPublisherEventType.RCL_PUBLISHER_LIVELINESS_LOST: ("liveliness", QoSLivelinessLostInfo),
    QoSPublisherEventType.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS: ("incompatible_qos", QoSOfferedIncompatibleQoSInfo),
    QoSPublisherEventType.RCL_PUBLISHER_MATCHED: ("matched", QoSPublisherMatchedInfo),
}
_OF_SUBSCRIPTIONS = {
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED: ("deadline", QoSRequestedDeadlineMissedInfo),
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_LIVELINESS_CHANGED: ("liveliness", QoSLivelinessChangedInfo),
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS: (
        "incompatible_qos",
        QoSRequestedIncompatibleQoSInfo,
    ),
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_MESSAGE_LOST: ("message_lost", QoSMessageLostInfo),
    QoSSubscriptionEventType.RCL_SUBSCRIPTION_MATCHED: ("matched", QoSSubscriptionMatchedInfo),
}
_EVENTS: dict[Any, tuple[str, type]] = {**_OF_PUBLISHERS, **_OF_SUBSCRIPTIONS}


class EventHandler(GraphWaitable):
    """Calls back with an event's status at the next spin.

    Raises:
        UnsupportedEventTypeError: If nothing tells of the event.
    """

    def __init__(self, *, callback_group: Any, callback: Callable[[Any], Any], event_type: Any, parent_impl: Any):
        if event_type not in _EVENTS:
            raise UnsupportedEventTypeError(f"{event_type.name}: types are compared before anything is sent")
        super().__init__(callback_group)
        self.callback, self.event_type = callback, event_type
        self._name, self._kind = _EVENTS[event_type]
        self._listeners = parent_impl.item.listeners
        self._listeners[self._name] = self._put
        self._status = self._kind()
        self._is_pending = False

    def _put(self, changes: dict[str, Any]) -> None:
        status = self._status
        for name, change in changes.items():
            if name.endswith("_count"):
                setattr(status, name, getattr(status, name) + change)
                setattr(status, f"{name}_change", getattr(status, f"{name}_change") + change)
            else:
                setattr(status, name, change)
        self._is_pending = True

    def is_ready(self, wait_set: Any) -> bool:
        return self._is_pending

    def take_data(self) -> Any:
        self._is_pending = False
        values = {item.name: getattr(self._status, item.name) for item in fields(self._kind)}
        self._status = self._kind(**{name: 0 if name.endswith("_change") else value for name, value in values.items()})
        return self._kind(**values)

    async def execute(self, taken_data: Any) -> None:
        found = self.callback(taken_data)
        if inspect.isawaitable(found):
            await found

    def destroy(self) -> None:
        self._listeners.pop(self._name, None)


class QoSEventHandler(EventHandler):
    """The older name."""

    def __init__(self, *args: Any, **kwargs: Any):
        super().__init__(*args, **kwargs)


class _EventCallbacks:
    """Callbacks by the events' names, and the line that is logged of settings that do not fit where none is given."""

    _types: dict[Any, tuple[str, type]]
    _line: str
    use_default_callbacks: bool

    def _create_handlers(self, callback_group: Any, impl: Any, topic_name: str) -> list[EventHandler]:
        """Return the handlers of what has a callback."""
        found: list[EventHandler] = []
        for kind, (name, _) in self._types.items():
            callback = getattr(self, name, None)
            if callback is None and name == "incompatible_qos" and self.use_default_callbacks:
                options = {"callback_group": callback_group, "event_type": kind, "parent_impl": impl}
                impl.item.listeners[name] = partial(_begin, found, impl, self._default(impl, topic_name), options)
            if callback is not None:
                options = {"callback_group": callback_group, "event_type": kind, "parent_impl": impl}
                found.append(EventHandler(callback=callback, **options))
        return found

    def _default(self, impl: Any, topic_name: str) -> Callable[[Any], None]:
        logger = get_logger(impl.get_logger_name())

        def warn(event: Any) -> None:
            policy = qos_policy_name_from_kind(event.last_policy_kind)
            logger.warning(f"{self._line.format(topic_name)} Last incompatible policy: {policy}")

        return warn


def _begin(handlers: list[EventHandler], impl: Any, warn: Any, options: dict[str, Any], changes: Any) -> None:
    """Let a default handler warn at the next spin; before the first event, executors have nothing to look at."""
    handler = EventHandler(callback=warn, **options)
    handlers.append(handler)
    impl.add_waitable(handler)
    handler._put(changes)


class SubscriptionEventCallbacks(_EventCallbacks):
    """Callbacks of a subscription."""

    _types: dict[Any, tuple[str, type]] = _OF_SUBSCRIPTIONS
    _line = "New publisher discovered on topic '{}', offering incompatible QoS. No messages will be received from it."

    def __init__(
        self,
        *,
        deadline: Callable[[Any], None] | None = None,
        incompatible_qos: Callable[[Any], None] | None = None,
        liveliness: Callable[[Any], None] | None = None,
        message_lost: Callable[[Any], None] | None = None,
        incompatible_type: Callable[[Any], None] | None = None,
        matched: Callable[[Any], None] | None = None,
        use_default_callbacks: bool = True,
    ):
        self.deadline, self.incompatible_qos, self.liveliness = deadline, incompatible_qos, liveliness
        self.message_lost, self.incompatible_type, self.matched = message_lost, incompatible_type, matched
        self.use_default_callbacks = use_default_callbacks

    def create_event_handlers(self, callback_group: Any, subscription: Any, topic_name: str) -> list[EventHandler]:
        return self._create_handlers(callback_group, subscription, topic_name)


class PublisherEventCallbacks(_EventCallbacks):
    """Callbacks of a publisher."""

    _types: dict[Any, tuple[str, type]] = _OF_PUBLISHERS
    _line = "New subscription discovered on topic '{}', requesting incompatible QoS. No messages will be sent to it."

    def __init__(
        self,
        *,
        deadline: Callable[[Any], None] | None = None,
        liveliness: Callable[[Any], None] | None = None,
        incompatible_qos: Callable[[Any], None] | None = None,
        incompatible_type: Callable[[Any], None] | None = None,
        matched: Callable[[Any], None] | None = None,
        use_default_callbacks: bool = True,
    ):
        self.deadline, self.liveliness, self.incompatible_qos = deadline, liveliness, incompatible_qos
        self.incompatible_type, self.matched = incompatible_type, matched
        self.use_default_callbacks = use_default_callbacks

    def create_event_handlers(self, callback_group: Any, publisher: Any, topic_name: str) -> list[EventHandler]:
        return self._create_handlers(callback_group, publisher, topic_name)
