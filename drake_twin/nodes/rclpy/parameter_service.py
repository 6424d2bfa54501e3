"""Stand-in for ``rclpy.parameter_service``."""

from collections import deque
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import Any

from drake_twin.nodes import message_classes
from drake_twin.nodes.graph_items import Offer
from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy.exceptions import ParameterNotDeclaredException, ParameterUninitializedException
from drake_twin.nodes.rclpy.parameter import Parameter
from drake_twin.nodes.task import present_task


class ParameterService:
    """The six services of a node's parameters; the node answers when it spins.

    Source: ros2/rclpy (jazzy), rclpy/rclpy/parameter_service.py.
    """

    def __init__(self, node: Any):
        self._node, self._graph = node, node.handle.graph
        self.callback_group = node.default_callback_group
        self._requests: deque[tuple[str, Any, Callable[[Any], None]]] = deque()
        own = node.get_fully_qualified_name()
        self._offers = []
        for name, (kind, _) in _SERVICES.items():
            full, service = node.resolve_service_name(f"~/{name}"), f"rcl_interfaces/srv/{kind}"
            self._offers.append(Offer(full, service, own, partial(self._put, name)))
        for offer in self._offers:
            self._graph.offer(offer)
        present_task().program.belongings.extend(self._offers)
        node.add_waitable(self)

    def _put(self, name: str, request: Any, reply: Callable[[Any], None]) -> None:
        self._requests.append((name, request, reply))

    def _is_ready(self) -> bool:
        return bool(self._requests)

    def _execute(self) -> None:
        name, request, reply = self._requests.popleft()
        kind, answer = _SERVICES[name]
        service = f"rcl_interfaces/srv/{kind}"
        response = message_class(f"{service}_Response")()
        answer(self._node, message_classes.from_wire(f"{service}_Request", request), response)
        reply(message_classes.to_wire(response))

    def destroy(self) -> None:
        for offer in self._offers:
            self._graph.withdraw(offer)


def _describe(node: Any, request: Any, response: Any) -> None:
    with suppress(ParameterNotDeclaredException):  # of one that is unknown, nothing at all
        response.descriptors = node.describe_parameters(request.names)


def _get(node: Any, request: Any, response: Any) -> None:
    found = []
    for name in request.names:
        try:
            found.append(node.get_parameter(name).get_parameter_value())
        except (ParameterNotDeclaredException, ParameterUninitializedException):
            return
    response.values = found


def _get_types(node: Any, request: Any, response: Any) -> None:
    with suppress(ParameterNotDeclaredException):
        response.types = [getattr(kind, "value", kind) for kind in node.get_parameter_types(request.names)]


def _list(node: Any, request: Any, response: Any) -> None:
    response.result = node.list_parameters(list(request.prefixes), request.depth)


def _set(node: Any, request: Any, response: Any) -> None:
    response.results = [_set_together(node, [item]) for item in request.parameters]


def _set_atomically(node: Any, request: Any, response: Any) -> None:
    response.result = _set_together(node, request.parameters)


def _set_together(node: Any, items: list[Any]) -> Any:
    try:
        return node.set_parameters_atomically([Parameter.from_parameter_msg(item) for item in items])
    except (ParameterNotDeclaredException, ValueError) as error:  # a peer may send a type that does not exist
        return message_class("rcl_interfaces/msg/SetParametersResult")(successful=False, reason=str(error))


_SERVICES: dict[str, tuple[str, Callable[[Any, Any, Any], None]]] = {
    "describe_parameters": ("DescribeParameters", _describe),
    "get_parameter_types": ("GetParameterTypes", _get_types),
    "get_parameters": ("GetParameters", _get),
    "list_parameters": ("ListParameters", _list),
    "set_parameters": ("SetParameters", _set),
    "set_parameters_atomically": ("SetParametersAtomically", _set_atomically),
}
