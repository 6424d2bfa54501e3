"""``drake-twin param``: the parameters of a running twin's nodes, as ``ros2 param`` has them."""

import argparse
import re
import sys
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from drake_twin.description.source_file import file_text
from drake_twin.errors import InputError
from drake_twin.messages.parameter_value import NOT_SET, flat, python_value, type_of, value_fields
from drake_twin.program import ArgumentParser
from drake_twin.tools.verb import Verb, run_verbs, yaml_values

if TYPE_CHECKING:
    from drake_twin.client import Client

_LIST = "/list_parameters"
_TYPES = [
    *("not set", "boolean", "integer", "double", "string", "byte array", "boolean array"),
    *("integer array", "double array", "string array"),
]
_LABELS = {  # rcl_interfaces/msg/ParameterType → what is said before a value
    1: "Boolean value is:",
    2: "Integer value is:",
    3: "Double value is:",
    4: "String value is:",
    5: "Byte values are:",
    6: "Boolean values are:",
    7: "Integer values are:",
    8: "Double values are:",
    9: "String values are:",
}


def _node(client: "Client", name: str) -> str:
    """Return the full name of a node that has parameters.

    Raises:
        InputError: If that name is unknown.
    """
    from drake_twin.client import full_name

    nodes = [service.removesuffix(_LIST) for service in client.services() if service.endswith(_LIST)]
    if full_name(name) not in nodes:
        raise InputError(f"no node {name!r} has parameters", value=full_name(name), valid=nodes)
    return full_name(name)


def _add_node(parser: ArgumentParser) -> None:
    parser.add_argument("node_name", metavar="NODE", help="the node")


def _add_list(parser: ArgumentParser) -> None:
    parser.add_argument("node_name", metavar="NODE", nargs="?", help="the node; by default all")
    parser.add_argument("--filter", metavar="REGEX", help="list only names that begin with this regular expression")
    parser.add_argument(
        "--param-prefixes", metavar="PREFIX", nargs="+", default=[], help="list only what is below these"
    )
    parser.add_argument("--param-type", action="store_true", help="show the types, too")


def _list(client: "Client", options: argparse.Namespace) -> int:
    if options.node_name is not None:
        nodes = [_node(client, options.node_name)]
    else:
        nodes = [service.removesuffix(_LIST) for service in client.services() if service.endswith(_LIST)]
    try:
        wanted = re.compile(options.filter or "")
    except re.error as error:
        raise InputError(f"--filter {options.filter!r} is not a regular expression: {error}") from None
    for node in nodes:
        if options.node_name is None:
            print(f"{node}:")
        found = client.call(node + _LIST, {"prefixes": options.param_prefixes}).result.names
        names = [name for name in sorted(found) if wanted.match(name)]
        types = client.call(f"{node}/get_parameter_types", {"names": names}).types if options.param_type else names
        for name, its in zip(names, types, strict=True):
            print(f"  {name} (type: {_TYPES[its]})" if options.param_type else f"  {name}")
    return 0


def _add_get(parser: ArgumentParser) -> None:
    _add_node(parser)
    parser.add_argument("parameter_name", metavar="NAME", help="the parameter")
    parser.add_argument("--hide-type", action="store_true", help="print only the value")


def _get(client: "Client", options: argparse.Namespace) -> int:
    node = _node(client, options.node_name)
    (value,) = client.call(f"{node}/get_parameters", {"names": [options.parameter_name]}).values
    if value.type not in _LABELS:
        known = client.call(node + _LIST).result.names
        raise InputError(
            f"{node} has no parameter {options.parameter_name!r}", value=options.parameter_name, valid=known
        )
    own = python_value(value)
    print(own if options.hide_type else f"{_LABELS[value.type]} {own}")
    return 0


def _add_set(parser: ArgumentParser) -> None:
    _add_node(parser)
    parser.add_argument("parameter_name", metavar="NAME", help="the parameter")
    parser.add_argument("value", metavar="VALUE", help="its value as YAML")


def _set(client: "Client", options: argparse.Namespace) -> int:
    done = "Set parameter successful", "Setting parameter failed"
    return _ask(client, options, {options.parameter_name: _value(options.value)}, done)


def _add_delete(parser: ArgumentParser) -> None:
    _add_node(parser)
    parser.add_argument("parameter_name", metavar="NAME", help="the parameter")


def _delete(client: "Client", options: argparse.Namespace) -> int:
    done = "Deleted parameter successfully", "Deleting parameter failed"
    return _ask(client, options, {options.parameter_name: {"type": NOT_SET}}, done)


def _add_load(parser: ArgumentParser) -> None:
    _add_node(parser)
    parser.add_argument("parameter_file", metavar="FILE", help="the file of parameters, as `dump` prints it")
    parser.add_argument("--no-use-wildcard", action="store_true", help="without those that the file has for all: /**")


def _load(client: "Client", options: argparse.Namespace) -> int:
    """Set what a file has for any node, as ``ros2 param load`` does: its sections need not name this one."""
    try:
        sections = yaml_values(file_text(options.parameter_file))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{options.parameter_file} cannot be read: {error}") from None
    sections = sections if isinstance(sections, Mapping) else {}
    of_all = {} if options.no_use_wildcard else sections.get("/**", {})
    found: dict[str, Any] = {}
    for section in (of_all, *(value for name, value in sections.items() if name != "/**")):
        if not isinstance(section, Mapping) or (section and "ros__parameters" not in section):
            raise InputError(f"{options.parameter_file}: a section has no ros__parameters")
        found.update(flat(section.get("ros__parameters", {})))
    if not found:
        raise InputError(f"{options.parameter_file} has no parameters")
    fields = {name: value_fields(value) for name, value in found.items()}
    return _ask(client, options, fields, ("Set parameter {} successful", "Set parameter {} failed"))


def _ask(
    client: "Client", options: argparse.Namespace, values: Mapping[str, Mapping[str, Any]], said: tuple[str, str]
) -> int:
    """Ask a node to set parameters, and say of each what became of it."""
    parameters = [{"name": name, "value": value} for name, value in values.items()]
    request = {"parameters": parameters}
    results = client.call(f"{_node(client, options.node_name)}/set_parameters", request).results
    for name, result in zip(values, results, strict=True):
        text = said[not result.successful].format(name) + (f": {result.reason}" if result.reason else "")
        print(text, file=sys.stdout if result.successful else sys.stderr)
    return int(not all(result.successful for result in results))


def _add_describe(parser: ArgumentParser) -> None:
    _add_node(parser)
    parser.add_argument("parameter_names", metavar="NAME", nargs="+", help="the parameters")


def _describe(client: "Client", options: argparse.Namespace) -> int:
    node = _node(client, options.node_name)
    for item in client.call(f"{node}/describe_parameters", {"names": options.parameter_names}).descriptors:
        print(f"Parameter name: {item.name}\n  Type: {_TYPES[item.type]}")
        if item.description:
            print(f"  Description: {item.description}")
        print("  Constraints:")
        if item.read_only:
            print("    Read only: true")
        for its in [*item.floating_point_range, *item.integer_range][:1]:
            step = f"\n    Step: {its.step}" if its.step else ""
            print(f"    Min value: {its.from_value}\n    Max value: {its.to_value}{step}")
        if item.additional_constraints:
            print(f"    Additional constraints: {item.additional_constraints}")
    return 0


def _dump(client: "Client", options: argparse.Namespace) -> int:
    import yaml

    node = _node(client, options.node_name)
    names = sorted(client.call(node + _LIST).result.names)
    values = client.call(f"{node}/get_parameters", {"names": names}).values
    nested: dict[str, Any] = {}
    for name, value in zip(names, values, strict=True):
        *above, last = name.split(".")
        place = nested
        for part in above:
            place = place.setdefault(part, {})
        place[last] = python_value(value)
    print(yaml.safe_dump({node: {"ros__parameters": nested}}, default_flow_style=False))
    return 0


def _value(text: str) -> Mapping[str, Any]:
    """Return a value as fields of a ``ParameterValue``; what is neither a number nor a list is a text."""
    data = yaml_values(text)
    is_mixed = isinstance(data, list) and len({*map(type, data)}) > 1
    return value_fields(text if is_mixed or type_of(data) == NOT_SET else data)


VERBS = {
    "list": Verb("list the parameters of a node, or of all", _add_list, _list),
    "get": Verb("print the value of a parameter", _add_get, _get),
    "set": Verb("set a parameter", _add_set, _set),
    "describe": Verb("print the types and ranges of parameters, and which are read-only", _add_describe, _describe),
    "delete": Verb("delete a parameter", _add_delete, _delete),
    "dump": Verb("print all parameters of a node as a file of parameters", _add_node, _dump),
    "load": Verb("set the parameters that a file has for a node", _add_load, _load),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program."""
    return run_verbs("param", VERBS, arguments)


if __name__ == "__main__":
    sys.exit(main())
