"""Parameters in Foxglove: those of all nodes as ``/node.parameter``, which the nodes' own services are asked for.

The names are those of ROS's foxglove_bridge.
"""

from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Future, wait
from typing import TYPE_CHECKING, Any

from drake_twin.messages.interface_types import deserialize, make, serialize
from drake_twin.messages.parameter_value import python_value, type_of, value_fields
from drake_twin.wires.wire import Reply, WireEndpoint

if TYPE_CHECKING:
    from foxglove.websocket import Parameter

_GET, _LIST, _SET = (f"rcl_interfaces/srv/{name}Parameters" for name in ("Get", "List", "Set"))
EVENT = "rcl_interfaces/msg/ParameterEvent"
_LONGEST = 5.0  # s of wall time in which a node answers
_FLOATS = {2: 3, 7: 8}  # the type of whole numbers → that of floats

Answer = Callable[[bytes, Reply], None]


class FoxgloveParameters:
    """The parameters of the nodes whose services are served. It is asked in threads of the server."""

    def __init__(self) -> None:
        self._answers: dict[tuple[str, str], Answer] = {}

    def add(self, service: WireEndpoint, answer: Answer) -> None:
        """Add a service, if it is one of a node's parameters."""
        if service.type in (_GET, _LIST, _SET) and service.name.rpartition("/")[0] == service.node:
            self._answers[service.node, service.type] = answer

    def remove(self, service: WireEndpoint) -> None:
        """Remove a service."""
        self._answers.pop((service.node, service.type), None)

    def get(self, names: Iterable[str] = ()) -> "list[Parameter]":
        """Return the parameters of these names, or all; those that no node has are left out."""
        from foxglove.websocket import Parameter

        wanted = _by_node(names)
        if not wanted:
            lists = self._ask(_LIST, {node: {} for node, kind in tuple(self._answers) if kind == _LIST})
            wanted = {node: list(response.result.names) for node, response in lists.items()}
        return [
            Parameter(f"{node}.{name}", value=value)
            for node, values in self._values(wanted).items()
            for name, value in zip(wanted[node], map(python_value, values), strict=True)
            if value is not None
        ]

    def changed(self, data: bytes) -> "list[Parameter]":
        """Return the parameters that an event (CDR) tells of, without those that are deleted."""
        from foxglove.websocket import Parameter

        event = deserialize(EVENT, data)
        return [
            Parameter(f"{event.node}.{item.name}", value=value)
            for item in (*event.new_parameters, *event.changed_parameters)
            if (value := python_value(item.value)) is not None
        ]

    def set(self, values: Mapping[str, Any]) -> list[str]:
        """Set parameters, and return why others were not set.

        Args:
            values: Name → value; None unsets one. Whole numbers are floats where the parameter is one now.
        """
        wanted = _by_node(values)
        requests = {
            node: {
                "parameters": [
                    _fields(name, values[f"{node}.{name}"], old) for name, old in zip(wanted[node], now, strict=True)
                ]
            }
            for node, now in self._values(wanted).items()
        }
        responses = self._ask(_SET, requests)
        gone = [f"{node} does not answer" for node in wanted.keys() - responses.keys()]
        return gone + [
            f"{node}.{name}: {result.reason}"
            for node, response in responses.items()
            for name, result in zip(wanted[node], response.results, strict=True)
            if not result.successful
        ]

    def _values(self, wanted: Mapping[str, list[str]]) -> dict[str, list[Any]]:
        responses = self._ask(_GET, {node: {"names": names} for node, names in wanted.items()})
        return {node: list(response.values) for node, response in responses.items()}

    def _ask(self, kind: str, requests: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
        """Ask all nodes at once; return their responses, without those of nodes that are gone or do not answer."""
        waiting: dict[str, Future[bytes]] = {}
        for node, fields in requests.items():
            if (answer := self._answers.get((node, kind))) is not None:
                waiting[node] = Future()
                answer(serialize(make(f"{kind}_Request", fields)), waiting[node].set_result)
        done, _ = wait(waiting.values(), _LONGEST)
        return {node: deserialize(f"{kind}_Response", item.result()) for node, item in waiting.items() if item in done}


def _by_node(names: Iterable[str]) -> dict[str, list[str]]:
    """Return node → names of parameters; a node's name has no dots."""
    found: dict[str, list[str]] = {}
    for full in names:
        node, _, name = full.partition(".")
        found.setdefault(node, []).append(name)
    return found


def _fields(name: str, value: Any, old: Any) -> dict[str, Any]:
    if value == []:
        return {"name": name, "value": {"type": old.type}}
    if _FLOATS.get(type_of(value)) == old.type:
        value = [*map(float, value)] if isinstance(value, list) else float(value)
    return {"name": name, "value": value_fields(value)}
