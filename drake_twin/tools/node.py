"""``drake-twin node list|info``: the nodes on the graph of a running twin, as ``ros2 node`` has them."""

import argparse
import sys
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from drake_twin.errors import InputError
from drake_twin.program import ArgumentParser
from drake_twin.tools.typed_names import print_names
from drake_twin.tools.verb import Verb, run_verbs

if TYPE_CHECKING:
    from drake_twin.client import Client

_GOAL = "/_action/send_goal"


def _add_list(parser: ArgumentParser) -> None:
    parser.add_argument("-a", "--all", action="store_true", help="list hidden ones, too")
    parser.add_argument("-c", "--count-nodes", action="store_true", help="print only how many there are")


def _list(client: "Client", options: argparse.Namespace) -> int:
    print_names([name for name in client.nodes() if options.all or "/_" not in name], options.count_nodes)
    return 0


def _add_info(parser: ArgumentParser) -> None:
    parser.add_argument("node_name", metavar="NODE", help="the node")
    parser.add_argument("--include-hidden", action="store_true", help="show what belongs to actions, too")


def _info(client: "Client", options: argparse.Namespace) -> int:
    from drake_twin.wires.rmw_zenoh_format import CLIENT, PUBLISHER, SERVICE, SUBSCRIPTION

    name = options.node_name
    if name not in client.nodes():
        raise InputError(f"Unable to find node {name!r}", value=name, valid=client.nodes())
    own = [item for item in client.entities() if item.node == name]

    def lines(kind: str) -> Iterator[str]:
        for item in sorted(own, key=lambda item: item.name):
            if item.kind == kind and (options.include_hidden or "/_" not in item.name):
                yield f"    {item.name}: {item.type}"

    def actions(kind: str) -> Iterator[str]:
        for item in sorted(own, key=lambda item: item.name):
            if item.kind == kind and item.name.endswith(_GOAL):
                yield f"    {item.name.removesuffix(_GOAL)}: {item.type.removesuffix('_SendGoal')}"

    kinds = (("Subscribers", SUBSCRIPTION), ("Publishers", PUBLISHER), ("Service Servers", SERVICE))
    print(name)
    for title, kind in (*kinds, ("Service Clients", CLIENT)):
        print(f"  {title}:", "\n".join(lines(kind)), sep="\n")
    for title, kind in (("Action Servers", SERVICE), ("Action Clients", CLIENT)):
        print(f"  {title}:", "\n".join(actions(kind)), sep="\n")
    return 0


VERBS = {
    "list": Verb("list the nodes", _add_list, _list),
    "info": Verb("print what a node publishes, hears, serves and calls", _add_info, _info),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program."""
    return run_verbs("node", VERBS, arguments)


if __name__ == "__main__":
    sys.exit(main())
