"""Stand-in for ``rclpy.lifecycle.node``."""

from typing import Any

from drake_twin.nodes.message_classes import message_class, service_class
from drake_twin.nodes.rclpy import node as rclpy_node
from drake_twin.nodes.rclpy._rclpy_pybind11 import RCLError
from drake_twin.nodes.rclpy.lifecycle.managed_entity import ManagedEntity
from drake_twin.nodes.rclpy.lifecycle.publisher import LifecyclePublisher
from drake_twin.nodes.rclpy.lifecycle.state_machine import (
    STATES,
    TRANSITIONS,
    LifecycleState,
    LifecycleTransition,
    StateMachine,
    TransitionCallbackReturn,
)

_CALLBACKS = {
    "configuring": "on_configure",
    "cleaningup": "on_cleanup",
    "shuttingdown": "on_shutdown",
    "activating": "on_activate",
    "deactivating": "on_deactivate",
    "errorprocessing": "on_error",
}


class LifecycleNodeMixin(ManagedEntity):
    """The states of a node."""

    def __init__(self, *, enable_communication_interface: bool = True, callback_group: Any = None):
        node: Any = self
        self._managed_entities: dict[ManagedEntity, None] = {}  # in order, so that a run repeats
        self._state_machine = StateMachine(enable_communication_interface)
        # As they were when the node was made: what a subclass has, also where it is replaced later.
        self._callbacks = {label: getattr(self, name) for label, name in _CALLBACKS.items()}
        if not enable_communication_interface:
            return
        event = message_class("lifecycle_msgs/msg/TransitionEvent")
        events = node.create_publisher(event, "~/transition_event", 10)
        self._state_machine.is_told = lambda item: events.publish(
            event(start_state=_message(item.start), goal_state=_message(item.goal))
        )
        for name, kind, answer in (
            ("change_state", "ChangeState", self.__on_change_state),
            ("get_state", "GetState", self.__on_get_state),
            ("get_available_states", "GetAvailableStates", self.__on_get_available_states),
            ("get_available_transitions", "GetAvailableTransitions", self.__on_get_available_transitions),
            ("get_transition_graph", "GetAvailableTransitions", self.__on_get_transition_graph),
        ):
            service = service_class(f"lifecycle_msgs/srv/{kind}")
            made = node.create_service(service, f"~/{name}", answer, callback_group=callback_group)
            self._state_machine.services[name] = made.handle
            setattr(self, f"_service_{name}", made)

    def trigger_configure(self) -> TransitionCallbackReturn:
        return self.__change_state(1)

    def trigger_cleanup(self) -> TransitionCallbackReturn:
        return self.__change_state(2)

    def trigger_activate(self) -> TransitionCallbackReturn:
        return self.__change_state(3)

    def trigger_deactivate(self) -> TransitionCallbackReturn:
        return self.__change_state(4)

    def trigger_shutdown(self) -> TransitionCallbackReturn:
        if not any(item.label == "shutdown" for item in self._state_machine.available):
            raise RCLError("Shutdown transtion not possible")
        return self.__change_state("shutdown")

    def add_managed_entity(self, entity: ManagedEntity) -> None:
        if not isinstance(entity, ManagedEntity):
            raise TypeError("Expected a rclpy.lifecycle.ManagedEntity instance.")
        self._managed_entities[entity] = None

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self.__pass_on("on_configure", state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self.__pass_on("on_cleanup", state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self.__pass_on("on_shutdown", state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self.__pass_on("on_activate", state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self.__pass_on("on_deactivate", state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self.__pass_on("on_error", state)

    def create_lifecycle_publisher(self, *args: Any, **kwargs: Any) -> LifecyclePublisher:
        if "publisher_class" in kwargs:
            raise TypeError("create_publisher() got an unexpected keyword argument 'publisher_class'")
        node: Any = self
        publisher: LifecyclePublisher = node.create_publisher(*args, publisher_class=LifecyclePublisher, **kwargs)
        self._managed_entities[publisher] = None
        return publisher

    def destroy_lifecycle_publisher(self, publisher: LifecyclePublisher) -> bool:
        node: Any = self
        self._managed_entities.pop(publisher, None)
        return bool(node.destroy_publisher(publisher))

    def __pass_on(self, name: str, state: LifecycleState) -> TransitionCallbackReturn:
        for entity in list(self._managed_entities):
            result = getattr(entity, name)(state)
            if not isinstance(result, TransitionCallbackReturn):
                text = f"{name}() return value of class {type(entity)} should be `TransitionCallbackReturn`."
                raise TypeError(text)
            if result is not TransitionCallbackReturn.SUCCESS:
                return result
        return TransitionCallbackReturn.SUCCESS

    def __change_state(self, key: int | str) -> TransitionCallbackReturn:
        before = self._state_machine.current
        self.__trigger(key)
        result = self.__called_back(before)
        self.__trigger(result.to_label())
        if result is TransitionCallbackReturn.ERROR:
            self.__trigger(self.__called_back(before).to_label())
        return result

    def __trigger(self, key: int | str) -> None:
        if isinstance(key, int):
            self._state_machine.trigger_transition_by_id(key, True)
        else:
            self._state_machine.trigger_transition_by_label(key, True)

    def __called_back(self, before: LifecycleState) -> TransitionCallbackReturn:
        label = self._state_machine.current.label
        try:
            result = self._callbacks[label](before)
        except Exception as error:  # ROS says nothing of it
            node: Any = self
            node.get_logger().error(f"{_CALLBACKS[label]}: {error}")
            return TransitionCallbackReturn.ERROR
        if not isinstance(result, TransitionCallbackReturn):
            raise AttributeError(f"{type(result).__name__!r} object has no attribute 'to_label'")
        return result

    # What its services answer ----------------------------------------------------------------------------------------

    def __on_change_state(self, request: Any, response: Any) -> Any:
        key = request.transition.label or request.transition.id
        if request.transition.label and not any(item.label == key for item in self._state_machine.available):
            response.success = False
            return response
        response.success = self.__change_state(key) is TransitionCallbackReturn.SUCCESS
        return response

    def __on_get_state(self, request: Any, response: Any) -> Any:
        _fill(response.current_state, self._state_machine.current)
        return response

    def __on_get_available_states(self, request: Any, response: Any) -> Any:
        for state in STATES.values():
            response.available_states.append(_message(state))
        return response

    def __on_get_available_transitions(self, request: Any, response: Any) -> Any:
        response.available_transitions = [_description(item) for item in self._state_machine.available]
        return response

    def __on_get_transition_graph(self, request: Any, response: Any) -> Any:
        response.available_transitions = [_description(item) for item in TRANSITIONS]
        return response


class LifecycleNode(LifecycleNodeMixin, rclpy_node.Node):
    """A node with states."""

    def __init__(self, node_name: str, *, enable_communication_interface: bool = True, **kwargs: Any):
        rclpy_node.Node.__init__(self, node_name, **kwargs)
        LifecycleNodeMixin.__init__(self, enable_communication_interface=enable_communication_interface)

    def destroy_node(self) -> None:
        self._managed_entities.clear()
        rclpy_node.Node.destroy_node(self)


def _fill(message: Any, state: LifecycleState) -> Any:
    message.id, message.label = state.state_id, state.label
    return message


def _message(state: LifecycleState) -> Any:
    return _fill(message_class("lifecycle_msgs/msg/State")(), state)


def _description(item: LifecycleTransition) -> Any:
    found = message_class("lifecycle_msgs/msg/TransitionDescription")()
    found.transition.id, found.transition.label = item.transition_id, item.label
    _fill(found.start_state, item.start)
    _fill(found.goal_state, item.goal)
    return found
