"""The ``<param>`` and ``<remap>`` elements of nodes."""

from collections.abc import Mapping, Sequence
from typing import Any

from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import Substitution
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
    pairs = [parser.parse_required(child, "from", "to") for child in entity.children_named("remap")]
    return [(pair["from"], pair["to"]) for pair in pairs]


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
    value, kind = entity.raw("value"), entity.get_attr("type", optional=True)
    separators = [entity.get_attr(name, optional=True) for name in ("sep", "value-sep")]
    if value is None:
        value = entity.get_attr("value")  # which refuses that it is missing
    if kind is not None and kind not in _TYPES:
        raise entity.error(f"unknown type {kind!r}", value=kind, valid=_TYPES)
    value_type = None if kind is None else _TYPES[kind]
    separator = separators[0] or separators[1]
    if separator is not None:
        return [parser.parse_substitution(part) for part in entity.get_attr("value").split(separator)]
    if isinstance(value, str):
        return ParameterValue(_Joined(parser.parse_substitution(value)), value_type=value_type)
    if isinstance(value, Sequence):
        return [_Joined(parser.parse_substitution(item)) if isinstance(item, str) else item for item in value]
    return value if value_type is None else ParameterValue(value, value_type=value_type)


class _Joined(Substitution):
    """Substitutions as one, so that they are not taken for a list of values."""

    def __init__(self, parts: list[Substitution]):
        self._parts = parts

    def perform(self, context: LaunchContext) -> str:
        return context.perform_substitution(self._parts)
