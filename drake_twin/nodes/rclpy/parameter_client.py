"""Stand-in for ``rclpy.parameter_client``."""

from collections.abc import Callable, Sequence
from typing import Any

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy.parameter import Parameter, parameter_dict_from_yaml_file
from drake_twin.nodes.rclpy.qos_profiles import qos_profile_parameter_events, qos_profile_services_default
from drake_twin.nodes.rclpy.task import Future

_Callback = Callable[[Future], None] | None


class AsyncParameterClient:
    """Asks for the parameters of another node, by its services."""

    def __init__(
        self,
        node: Any,
        remote_node_name: str,
        qos_profile: Any = qos_profile_services_default,
        callback_group: Any = None,
    ):
        from rcl_interfaces import srv

        self.remote_node_name, self.node = remote_node_name, node
        options = {"qos_profile": qos_profile, "callback_group": callback_group}

        def client(name: str, kind: Any) -> Any:
            return node.create_client(kind, f"{remote_node_name}/{name}", **options)

        self._srv = srv
        self._clients = {
            name: client(name, getattr(srv, kind))
            for name, kind in (
                ("get_parameters", "GetParameters"),
                ("set_parameters", "SetParameters"),
                ("list_parameters", "ListParameters"),
                ("describe_parameters", "DescribeParameters"),
                ("get_parameter_types", "GetParameterTypes"),
                ("set_parameters_atomically", "SetParametersAtomically"),
            )
        }

    def services_are_ready(self) -> bool:
        return all(item.service_is_ready() for item in self._clients.values())

    def wait_for_services(self, timeout_sec: float | None = None) -> bool:
        return all(item.wait_for_service(timeout_sec) for item in self._clients.values())

    def list_parameters(
        self, prefixes: list[str] | None = None, depth: int | None = None, callback: _Callback = None
    ) -> Future:
        request = self._srv.ListParameters.Request(prefixes=prefixes or [], depth=depth or 0)
        return self._asked("list_parameters", request, callback)

    def get_parameters(self, names: list[str], callback: _Callback = None) -> Future:
        return self._asked("get_parameters", self._srv.GetParameters.Request(names=names), callback)

    def set_parameters(self, parameters: Sequence[Any], callback: _Callback = None) -> Future:
        request = self._srv.SetParameters.Request(parameters=_messages(parameters))
        return self._asked("set_parameters", request, callback)

    def describe_parameters(self, names: list[str], callback: _Callback = None) -> Future:
        return self._asked("describe_parameters", self._srv.DescribeParameters.Request(names=names), callback)

    def get_parameter_types(self, names: list[str], callback: _Callback = None) -> Future:
        return self._asked("get_parameter_types", self._srv.GetParameterTypes.Request(names=names), callback)

    def set_parameters_atomically(self, parameters: Sequence[Any], callback: _Callback = None) -> Future:
        request = self._srv.SetParametersAtomically.Request(parameters=_messages(parameters))
        return self._asked("set_parameters_atomically", request, callback)

    def delete_parameters(self, names: list[str], callback: _Callback = None) -> Future:
        """Set parameters to nothing, which ends those that are typed dynamically."""
        return self.set_parameters([Parameter(name) for name in names], callback)

    def load_parameter_file(
        self, parameter_file: str, use_wildcard: bool = False, callback: _Callback = None
    ) -> Future:
        found = parameter_dict_from_yaml_file(parameter_file, use_wildcard)
        return self.set_parameters(list(found.values()), callback)

    def load_parameter_file_atomically(
        self, parameter_file: str, use_wildcard: bool = False, callback: _Callback = None
    ) -> Future:
        found = parameter_dict_from_yaml_file(parameter_file, use_wildcard)
        return self.set_parameters_atomically(list(found.values()), callback)

    def on_parameter_event(
        self,
        callback: Callable[[Any], None],
        qos_profile: Any = qos_profile_parameter_events,
        *,
        callback_group: Any = None,
        event_callbacks: Any = None,
        qos_overriding_options: Any = None,
        raw: bool = False,
    ) -> Any:
        """Subscribe to the events of all nodes' parameters."""
        return self.node.create_subscription(
            message_class("rcl_interfaces/msg/ParameterEvent"),
            "/parameter_events",
            callback,
            qos_profile,
            callback_group=callback_group,
            event_callbacks=event_callbacks,
            qos_overriding_options=qos_overriding_options,
            raw=raw,
        )

    def _asked(self, name: str, request: Any, callback: _Callback) -> Future:
        future: Future = self._clients[name].call_async(request)
        if callback is not None:
            future.add_done_callback(callback)
        return future


def _messages(parameters: Sequence[Any]) -> list[Any]:
    return [item.to_parameter_msg() if isinstance(item, Parameter) else item for item in parameters]
