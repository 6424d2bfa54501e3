"""The parameter services of the nodes on the graph, as in ``rcl_interfaces``.

The nodes are each robot's ``robot_state_publisher``, its ``controller_manager`` and its loaded controllers. Their
parameters are those that the robot's files give; they do not change while the twin runs.
"""

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

from drake_twin.messages.parameter_value import flat, python_value, type_of, value_fields
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.services.registry import Fields, Service
from drake_twin.twin.twin import Twin

Parameters = Mapping[str, Any]
_Answer = Callable[[Parameters, Any], Fields]


def parameter_services(twin: Twin) -> Iterator[Service]:
    """Yield the parameter services of all nodes of the robots."""
    for plan in twin.built.plans:
        for node, parameters in _nodes(twin, plan):
            for name, (kind, answer) in _ANSWERS.items():
                yield Service(f"{node}/{name}", f"rcl_interfaces/srv/{kind}", node, partial(answer, parameters))


def _nodes(twin: Twin, plan: RobotPlan) -> Iterator[tuple[str, Parameters]]:
    """Yield the full names of a robot's nodes with their parameters."""
    namespace, clock = plan.robot.topic_namespace, {"use_sim_time": True}
    of_publisher = {
        "robot_description": plan.description.text,
        "frame_prefix": plan.frame_prefix,
        "publish_frequency": plan.robot.publish_frequency,
    }
    yield f"{namespace}/robot_state_publisher", clock | of_publisher
    types = {f"{item.name}.type": item.type for item in plan.controllers}
    yield f"{namespace}/controller_manager", clock | {"update_rate": round(plan.manager.update_rate)} | types
    loaded = twin.control.manager(plan.name).states
    for controller in plan.controllers:
        if controller.name in loaded:
            yield f"{namespace}/{controller.name}", clock | dict(flat(controller.ros_parameters))


def _get_parameters(parameters: Parameters, request: Any) -> Fields:
    return {"values": [value_fields(parameters.get(name)) for name in request.names]}


def _get_parameter_types(parameters: Parameters, request: Any) -> Fields:
    return {"types": [type_of(parameters.get(name)) for name in request.names]}


def _describe_parameters(parameters: Parameters, request: Any) -> Fields:
    return {
        "descriptors": [
            {"name": name, "type": type_of(parameters.get(name)), "read_only": name in parameters}
            for name in request.names
        ]
    }


def _list_parameters(parameters: Parameters, request: Any) -> Fields:
    """List the parameters below prefixes, at most ``depth`` names deep; 0 is ``DEPTH_RECURSIVE``."""

    def is_listed(name: str, above: str) -> bool:
        below = name.removeprefix(f"{above}.") if above else name
        return (not above or name == above or below != name) and (
            request.depth == 0 or below.count(".") < request.depth
        )

    names = [name for name in parameters if any(is_listed(name, above) for above in request.prefixes or [""])]
    prefixes = dict.fromkeys(name.rpartition(".")[0] for name in names if "." in name)
    return {"result": {"names": names, "prefixes": [*prefixes]}}


def _set_parameters(parameters: Parameters, request: Any) -> Fields:
    return {"results": [_set(parameters, item) for item in request.parameters]}


def _set_parameters_atomically(parameters: Parameters, request: Any) -> Fields:
    results = [_set(parameters, item) for item in request.parameters]
    return {"result": next((item for item in results if not item["successful"]), {"successful": True, "reason": ""})}


def _set(parameters: Parameters, item: Any) -> Fields:
    """Return whether a parameter has the value already, for it cannot be changed."""
    is_same = item.name in parameters and value_fields(parameters[item.name]) == value_fields(python_value(item.value))
    reason = f"parameter {item.name!r} cannot be changed while the twin runs: the robot's files give it"
    return {"successful": is_same, "reason": "" if is_same else reason}


_ANSWERS: dict[str, tuple[str, _Answer]] = {
    "get_parameters": ("GetParameters", _get_parameters),
    "get_parameter_types": ("GetParameterTypes", _get_parameter_types),
    "describe_parameters": ("DescribeParameters", _describe_parameters),
    "list_parameters": ("ListParameters", _list_parameters),
    "set_parameters": ("SetParameters", _set_parameters),
    "set_parameters_atomically": ("SetParametersAtomically", _set_parameters_atomically),
}
