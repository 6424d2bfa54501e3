"""Stand-in for ``rclpy.service_introspection``, and the events that services and clients publish."""

from typing import Any

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy.native import native_enum
from drake_twin.nodes.rclpy.publisher import PublisherHandle
from drake_twin.nodes.rclpy.qos_profiles import profile_of

ServiceIntrospectionState = native_enum(
    "ServiceIntrospectionState",
    "What is published of requests and responses.",
    __name__,
    OFF=0,
    METADATA=1,
    CONTENTS=2,
)


_KINDS = ("REQUEST_SENT", "REQUEST_RECEIVED", "RESPONSE_SENT", "RESPONSE_RECEIVED")


class Introspection:
    """The events of a service or a client, once they are configured.

    Args:
        node: The node.
        srv_type: The class of the service.
        name: Its full name.
    """

    def __init__(self, node: Any, srv_type: Any, name: str):
        self._node, self._type, self._topic = node, srv_type, f"{name}/_service_event"
        self._state = ServiceIntrospectionState.OFF
        self._publisher: Any = None
        self._clock: Any = None
        self._count = 0

    def configure(self, clock: Any, profile: Any, state: Any) -> None:
        """Set what is published, with which quality of service."""
        self.end()
        if not isinstance(state, ServiceIntrospectionState):
            raise TypeError(f"configure_introspection(): incompatible function arguments: {state!r}")
        self._state, self._clock = state, clock
        if self._state is not ServiceIntrospectionState.OFF:
            self._publisher = PublisherHandle(self._node, self._type.Event, self._topic, profile_of(profile))
            self._publisher.advertise()

    def note(self, kind: str, message: Any) -> None:
        """Publish what has happened."""
        if self._publisher is None:
            return
        info = message_class("service_msgs/msg/ServiceEventInfo")(event_type=_KINDS.index(kind))
        info.stamp = self._clock.now().to_msg()
        self._count += "REQUEST" in kind
        info.sequence_number = self._count
        event = self._type.Event(info=info)
        if self._state is ServiceIntrospectionState.CONTENTS:
            setattr(event, "request" if "REQUEST" in kind else "response", [message])
        self._publisher.publish(event)

    def end(self) -> None:
        """Publish no more."""
        if self._publisher is not None:
            self._publisher.destroy_when_not_in_use()
        self._publisher = None
