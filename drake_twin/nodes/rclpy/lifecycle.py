"""Stand-in for ``rclpy.lifecycle``: the states and their callbacks; transitions are triggered by services."""

from collections.abc import Callable
from enum import IntEnum
from typing import Any, NamedTuple

from drake_twin.nodes.rclpy import node as rclpy_node
from drake_twin.nodes.rclpy import publisher as rclpy_publisher


class LifecycleState(NamedTuple):
    """A state of a node."""

    label: str
    state_id: int


State = LifecycleState


class TransitionCallbackReturn(IntEnum):
    """How a transition ends."""

    SUCCESS = 97
    FAILURE = 98
    ERROR = 99


UNCONFIGURED, INACTIVE = LifecycleState("unconfigured", 1), LifecycleState("inactive", 2)
ACTIVE, FINALIZED = LifecycleState("active", 3), LifecycleState("finalized", 4)

# The transition's number → its name, the states that it begins in, the state that it ends in.
_TRANSITIONS = {
    1: ("configure", (UNCONFIGURED,), INACTIVE),
    2: ("cleanup", (INACTIVE,), UNCONFIGURED),
    3: ("activate", (INACTIVE,), ACTIVE),
    4: ("deactivate", (ACTIVE,), INACTIVE),
    5: ("shutdown", (UNCONFIGURED,), FINALIZED),
    6: ("shutdown", (INACTIVE,), FINALIZED),
    7: ("shutdown", (ACTIVE,), FINALIZED),
}


class ManagedEntity:
    """Something that follows the states of its node."""

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        return TransitionCallbackReturn.SUCCESS

    on_cleanup = on_shutdown = on_activate = on_deactivate = on_error = on_configure


class LifecyclePublisher(rclpy_publisher.Publisher):
    """A publisher that is silent while its node is not active."""

    is_activated = False

    def publish(self, msg: Any) -> None:
        if self.is_activated:
            super().publish(msg)


class LifecycleNodeMixin(ManagedEntity):
    """The states of a node."""

    _state = UNCONFIGURED

    def __init__(self, *, enable_communication_interface: bool = True, callback_group: Any = None):
        self._managed: list[ManagedEntity] = []
        if enable_communication_interface:
            from lifecycle_msgs.srv import ChangeState, GetState

            node: Any = self
            node.create_service(ChangeState, "~/change_state", self._change_state, callback_group=callback_group)
            node.create_service(GetState, "~/get_state", self._get_state, callback_group=callback_group)

    def add_managed_entity(self, entity: ManagedEntity) -> None:
        self._managed.append(entity)

    def trigger_configure(self) -> TransitionCallbackReturn:
        return self._trigger("configure")

    def trigger_cleanup(self) -> TransitionCallbackReturn:
        return self._trigger("cleanup")

    def trigger_shutdown(self) -> TransitionCallbackReturn:
        return self._trigger("shutdown")

    def trigger_activate(self) -> TransitionCallbackReturn:
        return self._trigger("activate")

    def trigger_deactivate(self) -> TransitionCallbackReturn:
        return self._trigger("deactivate")

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        self._set_publishers(is_activated=True)
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        self._set_publishers(is_activated=False)
        return TransitionCallbackReturn.SUCCESS

    def create_lifecycle_publisher(self, *arguments: Any, **options: Any) -> LifecyclePublisher:
        node: Any = self
        publisher: LifecyclePublisher = node.create_publisher(*arguments, publisher_class=LifecyclePublisher, **options)
        return publisher

    def _set_publishers(self, *, is_activated: bool) -> None:
        node: Any = self
        for publisher in node.publishers:
            if isinstance(publisher, LifecyclePublisher):
                publisher.is_activated = is_activated

    def _trigger(self, name: str) -> TransitionCallbackReturn:
        ends = [end for known, begins, end in _TRANSITIONS.values() if known == name and self._state in begins]
        if not ends:
            raise RuntimeError(f"no transition matching {name} found for current state {self._state.label}")
        before = self._state
        callbacks: list[Callable[[LifecycleState], Any]] = [
            getattr(item, f"on_{name}") for item in (*self._managed, self)
        ]
        for callback in callbacks:
            try:
                result = callback(before)
            except Exception as error:
                node: Any = self
                node.get_logger().error(f"on_{name}: {error}")
                result = TransitionCallbackReturn.ERROR
            if result == TransitionCallbackReturn.ERROR:
                recovered = self.on_error(before) == TransitionCallbackReturn.SUCCESS
                self._state = UNCONFIGURED if recovered else FINALIZED
                return TransitionCallbackReturn.ERROR
            if result != TransitionCallbackReturn.SUCCESS:
                return TransitionCallbackReturn.FAILURE
        self._state = ends[0]
        return TransitionCallbackReturn.SUCCESS

    def _change_state(self, request: Any, response: Any) -> Any:
        known = _TRANSITIONS.get(request.transition.id)
        name = request.transition.label or (known[0] if known else "")
        try:
            response.success = self._trigger(name) == TransitionCallbackReturn.SUCCESS
        except RuntimeError:
            response.success = False
        return response

    def _get_state(self, request: Any, response: Any) -> Any:
        response.current_state.id, response.current_state.label = self._state.state_id, self._state.label
        return response


class LifecycleNode(LifecycleNodeMixin, rclpy_node.Node):
    """A node with states."""

    def __init__(self, node_name: str, *, enable_communication_interface: bool = True, **options: Any):
        rclpy_node.Node.__init__(self, node_name, **options)
        LifecycleNodeMixin.__init__(self, enable_communication_interface=enable_communication_interface)


# Their shorter names in rclpy.
Node, NodeMixin, Publisher = LifecycleNode, LifecycleNodeMixin, LifecyclePublisher
