"""The ``<param>`` and ``<remap>`` elements of nodes."""

from collections.abc import Mapping
from typing import Any

from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch_ros.parameter_descriptions import ParameterFile, ParameterValue

_TYPES: Mapping[str, Any] = {
    "str": str,
    "int": int,
    "float": float,
    "bool": bool,
    "list_of_str": list[str],
    "list_of_int": list[int],
    "list_of_float": list[float],
    "list_of_bool": list[bool],
}


def parse_remappings(entity: Entity, parser: Parser) -> list[tuple[Any, Any]]:
    """Return the remappings of a node's element."""
    return [(pair["from"], pair["to"]) for pair in parser.parse_children(entity, "remap", "from", "to")]


def parse_parameters(entity: Entity, parser: Parser) -> list[Any]:
    """Return the parameters of a node's element: files and single values.

    Raises:
        InputError: If one has neither a name nor a file, or a value is missing or not of its type.
    """
    entries: list[Any] = []
    for child in entity.children_named("param"):
        if "from" in child:
            allowed = parser.parse_optional(child, "allow_substs")
            entries.append(ParameterFile(parser.parse_required(child, "from")["from"], **allowed))
        elif "name" in child:
            entries.append({tuple(parser.parse_required(child, "name")["name"]): parse_parameter_value(child, parser)})
        else:
            raise child.error("a param has a name or a file (from)")
        child.assert_entity_completely_parsed()
    return entries


def parse_parameter_value(entity: Entity, parser: Parser) -> Any:
    """Return the value of an element's parameter; a mapping where it holds ``<param>`` elements.

    Raises:
        InputError: If it is missing, or its type is unknown.
    """
    nested = entity.children_named("param")
    if nested:
        return {
            tuple(parser.parse_required(child, "name")["name"]): parse_parameter_value(child, parser)
            for child in nested
        }
    kind = entity.get_attr("type", optional=True)
    if kind is not None and kind not in _TYPES:
        raise entity.error(f"unknown type {kind!r}", value=kind, valid=_TYPES)
    value_type = None if kind is None else _TYPES[kind]
    if "sep" in entity:
        entity.refused_by_ros("ROS 2 calls its attribute sep value-sep")
        value: Any = entity.get_attr("value").split(entity.get_attr("sep"))
        return [parser.parse_substitution(part) for part in value]
    value = entity.get_attr("value", data_type=value_type)
    return ParameterValue(parser.parse_if_substitutions(value), value_type=value_type)
