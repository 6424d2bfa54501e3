"""Stand-in for ``rclpy.parameter_client``."""

from typing import Any

from drake_twin.nodes.rclpy.parameter import Parameter
from drake_twin.nodes.rclpy.task import Future


class AsyncParameterClient:
    """Asks for the parameters of another node, by its services."""

    def __init__(self, node: Any, remote_node_name: str, qos_profile: Any = None, callback_group: Any = None):
        from rcl_interfaces import srv

        options = {"qos_profile": qos_profile, "callback_group": callback_group}

        def client(name: str, kind: Any) -> Any:
            return node.create_client(kind, f"{remote_node_name}/{name}", **options)

        self._srv = srv
        self._get = client("get_parameters", srv.GetParameters)
        self._set = client("set_parameters", srv.SetParameters)
        self._list = client("list_parameters", srv.ListParameters)
        self._describe = client("describe_parameters", srv.DescribeParameters)

    def services_are_ready(self) -> bool:
        return all(item.service_is_ready() for item in (self._get, self._set, self._list, self._describe))

    def wait_for_services(self, timeout_sec: float | None = None) -> bool:
        return all(item.wait_for_service(timeout_sec) for item in (self._get, self._set, self._list, self._describe))

    def get_parameters(self, names: list[str], callback: Any = None) -> Future:
        return self._asked(self._get, self._srv.GetParameters.Request(names=names), callback)

    def set_parameters(self, parameters: list[Any], callback: Any = None) -> Future:
        items = [item.to_parameter_msg() if isinstance(item, Parameter) else item for item in parameters]
        return self._asked(self._set, self._srv.SetParameters.Request(parameters=items), callback)

    def list_parameters(self, prefixes: Any = None, depth: Any = None, callback: Any = None) -> Future:
        request = self._srv.ListParameters.Request(prefixes=prefixes or [], depth=depth or 0)
        return self._asked(self._list, request, callback)

    def describe_parameters(self, names: list[str], callback: Any = None) -> Future:
        return self._asked(self._describe, self._srv.DescribeParameters.Request(names=names), callback)

    def _asked(self, client: Any, request: Any, callback: Any) -> Future:
        future: Future = client.call_async(request)
        if callback is not None:
            future.add_done_callback(callback)
        return future
