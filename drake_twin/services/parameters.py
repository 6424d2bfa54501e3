"""The parameter services of the nodes on the graph, as in ``rcl_interfaces``.

The nodes are each robot's ``robot_state_publisher``, its ``controller_manager`` and its loaded controllers, and those
of the twin's own services and topics, whose parameters are constant.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.description.declared_parameters import DeclaredParameter
from drake_twin.errors import InputError
from drake_twin.messages.parameter_value import python_value, type_of
from drake_twin.planning.node_parameters import CONTROLLER_MANAGER, STATE_PUBLISHER, use_sim_time
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.services.registry import Fields, Service
from drake_twin.twin.parameter_changes import value_of
from drake_twin.twin.twin import Twin

Parameters = Mapping[str, DeclaredParameter]
_SETS = ("set_parameters", "set_parameters_atomically")


@dataclass(frozen=True)
class ParameterNode:
    """A node with parameters.

    Attributes:
        name: Its full name.
        declared: Returns its parameters by their names.
        put: Sets values, all or none, and returns why not.
        builds: Whether it does what a callback cannot do to set them.
    """

    name: str
    declared: Callable[[], Parameters]
    put: Callable[[Mapping[str, Any]], str]
    builds: bool = False


_Answer = Callable[[ParameterNode, Any], Fields]


def parameter_services(twin: Twin, others: Iterable[str]) -> Iterator[Service]:
    """Yield the parameter services of all nodes.

    Args:
        twin: The twin, with the nodes of its robots.
        others: Full names of nodes; those that are no robot's have the time of ``/clock`` alone.
    """
    nodes = {node.name: node for node in parameter_nodes(twin)}
    of_robots = {f"{plan.robot.topic_namespace}/{item.name}" for plan in twin.built.plans for item in plan.controllers}
    for other in sorted({*others} - nodes.keys() - of_robots):  # a controller that is not loaded has none
        nodes[other] = constant_node(other, {})
    for node in nodes.values():
        for name, (kind, answer) in _ANSWERS.items():
            between = node.builds and name in _SETS
            full = f"{node.name}/{name}"
            yield Service(full, f"rcl_interfaces/srv/{kind}", node.name, partial(answer, node), between)


def parameter_nodes(twin: Twin) -> Iterator[ParameterNode]:
    """Yield the nodes of all robots: their state publishers, controller managers and loaded controllers."""
    for plan in twin.built.plans:
        yield from _nodes(twin, plan)


def _nodes(twin: Twin, plan: RobotPlan) -> Iterator[ParameterNode]:
    """Yield a robot's nodes."""
    for name in (STATE_PUBLISHER, CONTROLLER_MANAGER):
        yield _settable(twin, plan, name)
    loaded = twin.control.manager(plan.name).states
    for name in [item.name for item in plan.controllers if item.name in loaded]:
        yield _settable(twin, plan, name)


def _settable(twin: Twin, plan: RobotPlan, name: str) -> ParameterNode:
    declared, put = partial(twin.control.parameters, plan.name, name), partial(_put, twin, plan.name, name)
    return ParameterNode(f"{plan.robot.topic_namespace}/{name}", declared, put, builds=True)


def constant_node(name: str, values: Mapping[str, Any]) -> ParameterNode:
    """Return a node whose parameters are what they are.

    Args:
        name: Its full name.
        values: Parameter → value.
    """
    own = use_sim_time()
    known = {own.name: own} | {
        key: DeclaredParameter(key, type_of(value), value, is_read_only=True) for key, value in values.items()
    }

    def put(given: Mapping[str, Any]) -> str:
        for key, value in given.items():
            if key not in known or _value(known[key]) != value_of(type_of(value), value):
                return f"parameter {key!r} cannot be changed while the twin runs"
        return ""

    return ParameterNode(name, lambda: known, put)


def _put(twin: Twin, robot: str, controller: str, values: Mapping[str, Any]) -> str:
    try:
        twin.control.set_parameters(robot, controller, values)
    except InputError as error:
        return error.message
    return ""


def _value(item: DeclaredParameter | None) -> Fields:
    return {"type": 0} if item is None else value_of(item.type, item.value)


def _get_parameters(node: ParameterNode, request: Any) -> Fields:
    declared = node.declared()
    return {"values": [_value(declared.get(name)) for name in request.names]}


def _get_parameter_types(node: ParameterNode, request: Any) -> Fields:
    declared = node.declared()
    return {"types": [declared[name].type if name in declared else 0 for name in request.names]}


def _describe_parameters(node: ParameterNode, request: Any) -> Fields:
    declared = node.declared()
    return {"descriptors": [_descriptor(name, declared.get(name)) for name in request.names]}


def _descriptor(name: str, item: DeclaredParameter | None) -> Fields:
    if item is None:
        return {"name": name, "type": 0}
    fields: dict[str, Any] = {
        "name": name,
        "type": item.type,
        "description": item.description,
        "additional_constraints": item.constraints,
        "read_only": item.is_read_only,
    }
    if item.bounds is not None:
        kind, number = ("integer_range", int) if item.is_whole else ("floating_point_range", float)
        lower, upper = map(number, item.bounds)
        fields[kind] = [{"from_value": lower, "to_value": upper, "step": number(0)}]
    return fields


def _list_parameters(node: ParameterNode, request: Any) -> Fields:
    """List the parameters below prefixes, at most ``depth`` names deep; 0 is ``DEPTH_RECURSIVE``."""

    def is_listed(name: str, above: str) -> bool:
        below = name.removeprefix(f"{above}.") if above else name
        return (not above or name == above or below != name) and (
            request.depth == 0 or below.count(".") < request.depth
        )

    names = [name for name in node.declared() if any(is_listed(name, above) for above in request.prefixes or [""])]
    prefixes = dict.fromkeys(name.rpartition(".")[0] for name in names if "." in name)
    return {"result": {"names": names, "prefixes": [*prefixes]}}


def _set_parameters(node: ParameterNode, request: Any) -> Fields:
    """Set each parameter by itself; all at once if that can be done, for each may take a while."""
    values = [(item.name, python_value(item.value)) for item in request.parameters]
    if 1 < len(values) == len(dict(values)) and not node.put(dict(values)):
        return {"results": [_result("") for _ in values]}
    return {"results": [_result(node.put({name: value})) for name, value in values]}


def _set_parameters_atomically(node: ParameterNode, request: Any) -> Fields:
    return {"result": _result(node.put({item.name: python_value(item.value) for item in request.parameters}))}


def _result(reason: str) -> Fields:
    return {"successful": not reason, "reason": reason}


_ANSWERS: dict[str, tuple[str, _Answer]] = {
    "get_parameters": ("GetParameters", _get_parameters),
    "get_parameter_types": ("GetParameterTypes", _get_parameter_types),
    "describe_parameters": ("DescribeParameters", _describe_parameters),
    "list_parameters": ("ListParameters", _list_parameters),
    "set_parameters": ("SetParameters", _set_parameters),
    "set_parameters_atomically": ("SetParametersAtomically", _set_parameters_atomically),
}
