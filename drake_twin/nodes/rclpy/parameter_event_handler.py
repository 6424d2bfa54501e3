"""Stand-in for ``rclpy.parameter_event_handler``: callbacks for ``/parameter_events``."""

from collections import defaultdict
from collections.abc import Callable, Iterator
from threading import Lock
from typing import Any

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy.callback_groups import CallbackGroup
from drake_twin.nodes.rclpy.node import Node
from drake_twin.nodes.rclpy.qos_profiles import qos_profile_parameter_events


class ParameterEventCallbackHandle:
    """A callback for events."""

    def __init__(self, callback: Callable[[Any], None]):
        self.callback = callback
        self.mutex = Lock()


class ParameterCallbackHandle(ParameterEventCallbackHandle):
    """A callback for one parameter of a node."""

    def __init__(self, parameter_name: str, node_name: str, callback: Callable[[Any], None]):
        super().__init__(callback)
        self.parameter_name, self.node_name = parameter_name, node_name


class Callbacks:
    """Callbacks; the one that was added last is called first."""

    def __init__(self) -> None:
        self.parameter_callbacks: dict[tuple[str, str], list[ParameterCallbackHandle]] = defaultdict(list)
        self.event_callbacks: list[ParameterEventCallbackHandle] = []
        self.mutex = Lock()

    def event_callback(self, event: Any) -> None:
        with self.mutex:
            for (name, node), handles in self.parameter_callbacks.items():
                parameter = ParameterEventHandler.get_parameter_from_event(event, name, node)
                for handle in handles if parameter is not None else ():
                    with handle.mutex:
                        handle.callback(parameter)
            for event_handle in self.event_callbacks:
                with event_handle.mutex:
                    event_handle.callback(event)

    def add_parameter_callback(
        self, parameter_name: str, node_name: str, callback: Callable[[Any], None]
    ) -> ParameterCallbackHandle:
        handle = ParameterCallbackHandle(parameter_name, node_name, callback)
        with self.mutex:
            self.parameter_callbacks[parameter_name, node_name].insert(0, handle)
        return handle

    def remove_parameter_callback(self, handle: ParameterCallbackHandle) -> None:
        key = handle.parameter_name, handle.node_name
        with self.mutex:
            if handle not in self.parameter_callbacks.get(key, ()):
                raise RuntimeError("Callback doesn't exist")
            self.parameter_callbacks[key].remove(handle)
            if not self.parameter_callbacks[key]:
                del self.parameter_callbacks[key]

    def add_parameter_event_callback(self, callback: Callable[[Any], None]) -> ParameterEventCallbackHandle:
        handle = ParameterEventCallbackHandle(callback)
        with self.mutex:
            self.event_callbacks.insert(0, handle)
        return handle

    def remove_parameter_event_callback(self, handle: ParameterEventCallbackHandle) -> None:
        with self.mutex:
            if handle not in self.event_callbacks:
                raise RuntimeError("Callback doesn't exist")
            self.event_callbacks.remove(handle)


class ParameterEventHandler:
    """Calls back for parameters that are new or changed, of any node."""

    Callbacks = Callbacks

    def __init__(
        self,
        node: Node,
        qos_profile: Any = qos_profile_parameter_events,
        callback_group: CallbackGroup | None = None,
        event_callbacks: Any = None,
        qos_overriding_options: Any = None,
        raw: bool = False,
    ):
        self.node, self.qos_profile = node, qos_profile
        self._callbacks = Callbacks()
        self.parameter_event_subscription = node.create_subscription(
            message_class("rcl_interfaces/msg/ParameterEvent"),
            "/parameter_events",
            self._callbacks.event_callback,
            qos_profile,
            callback_group=callback_group,
            event_callbacks=event_callbacks,
            qos_overriding_options=qos_overriding_options,
            raw=raw,
        )

    def destroy(self) -> None:
        self.node.destroy_subscription(self.parameter_event_subscription)

    @staticmethod
    def get_parameter_from_event(event: Any, parameter_name: str, node_name: str) -> Any:
        if event.node != node_name:
            return None
        parameters = ParameterEventHandler.get_parameters_from_event(event)
        return next((item for item in parameters if item.name == parameter_name), None)

    @staticmethod
    def get_parameters_from_event(event: Any) -> Iterator[Any]:
        yield from event.new_parameters
        yield from event.changed_parameters

    def add_parameter_callback(
        self, parameter_name: str, node_name: str, callback: Callable[[Any], None]
    ) -> ParameterCallbackHandle:
        return self._callbacks.add_parameter_callback(parameter_name, self._resolve_path(node_name), callback)

    def remove_parameter_callback(self, handle: ParameterCallbackHandle) -> None:
        self._callbacks.remove_parameter_callback(handle)

    def add_parameter_event_callback(self, callback: Callable[[Any], None]) -> ParameterEventCallbackHandle:
        return self._callbacks.add_parameter_event_callback(callback)

    def remove_parameter_event_callback(self, handle: ParameterEventCallbackHandle) -> None:
        self._callbacks.remove_parameter_event_callback(handle)

    def _resolve_path(self, node: str) -> str:
        """Return a node's full name: a relative one is in the namespace of the handler's own node, "" that node."""
        if not node:
            return self.node.get_fully_qualified_name()
        return node if node.startswith("/") else f"{self.node.get_namespace().rstrip('/')}/{node}"
