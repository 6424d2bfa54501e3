"""``drake-twin param list|get|set``: the parameters of a running twin's nodes, as ``ros2 param`` has them."""

import argparse
import sys
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from drake_twin.errors import InputError
from drake_twin.messages.parameter_value import NOT_SET, python_value, type_of, value_fields
from drake_twin.program import ArgumentParser
from drake_twin.tools.verb import Verb, run_verbs, yaml_values

if TYPE_CHECKING:
    from drake_twin.client import Client

_LIST = "/list_parameters"
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


def _add_list(parser: ArgumentParser) -> None:
    parser.add_argument("node_name", metavar="NODE", nargs="?", help="the node; by default all")


def _list(client: "Client", options: argparse.Namespace) -> int:
    if options.node_name is not None:
        nodes = [_node(client, options.node_name)]
    else:
        nodes = [service.removesuffix(_LIST) for service in client.services() if service.endswith(_LIST)]
    for node in nodes:
        if options.node_name is None:
            print(f"{node}:")
        for name in sorted(client.call(node + _LIST).result.names):
            print(f"  {name}")
    return 0


def _add_get(parser: ArgumentParser) -> None:
    parser.add_argument("node_name", metavar="NODE", help="the node")
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
    _add_get(parser)
    parser.add_argument("value", metavar="VALUE", help="its value as YAML")


def _set(client: "Client", options: argparse.Namespace) -> int:
    node = _node(client, options.node_name)
    parameter = {"name": options.parameter_name, "value": _value(options.value)}
    (result,) = client.call(f"{node}/set_parameters", {"parameters": [parameter]}).results
    reason = f": {result.reason}" if result.reason else ""
    if result.successful:
        print(f"Set parameter successful{reason}")
        return 0
    print(f"Setting parameter failed{reason}", file=sys.stderr)
    return 1


def _value(text: str) -> Mapping[str, Any]:
    """Return a value as fields of a ``ParameterValue``; what is neither a number nor a list is a text."""
    data = yaml_values(text)
    is_mixed = isinstance(data, list) and len({*map(type, data)}) > 1
    return value_fields(text if is_mixed or type_of(data) == NOT_SET else data)


VERBS = {
    "list": Verb("list the parameters of a node, or of all", _add_list, _list),
    "get": Verb("print the value of a parameter", _add_get, _get),
    "set": Verb("set a parameter", _add_set, _set),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program."""
    return run_verbs("param", VERBS, arguments)


if __name__ == "__main__":
    sys.exit(main())
