"""The verbs ``list``, ``type`` and ``find`` of what has a name and a type: topics, services, actions."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from drake_twin.program import ArgumentParser
from drake_twin.tools.verb import Verb

if TYPE_CHECKING:
    import argparse

    from drake_twin.client import Client


def typed_names(
    noun: str,
    known: "Callable[[Client], Mapping[str, str]]",
    *,
    have_hidden: bool = True,
    details: "Callable[[Client, Mapping[str, str]], str] | None" = None,
) -> dict[str, Verb]:
    """Return the verbs.

    Args:
        noun: What they are about, in the plural.
        known: Returns what there is, each with its type.
        have_hidden: Whether some belong to actions, and are hidden.
        details: Returns what ``list --verbose`` prints of some of them; None without that option.
    """
    one = noun.removesuffix("s")

    def add_both(parser: ArgumentParser) -> None:
        text = "print only how many there are"
        parser.add_argument("-c", f"--count-{noun}", dest="count", action="store_true", help=text)
        if have_hidden:
            text = "those of actions, too"
            parser.add_argument(f"--include-hidden-{noun}", dest="hidden", action="store_true", help=text)

    def add_list(parser: ArgumentParser) -> None:
        parser.add_argument("-t", "--show-types", action="store_true", help="show the types, too")
        if details is not None:
            parser.add_argument("-v", "--verbose", action="store_true", help="show who has them, too")
        add_both(parser)

    def shown(client: "Client", options: "argparse.Namespace") -> dict[str, str]:
        is_shown = not have_hidden or options.hidden
        return {name: kind for name, kind in known(client).items() if is_shown or "/_" not in name}

    def print_list(client: "Client", options: "argparse.Namespace") -> int:
        found = shown(client, options)
        if details is not None and options.verbose and not options.count:
            print(details(client, found))
            return 0
        print_names([f"{name} [{kind}]" if options.show_types else name for name, kind in found.items()], options.count)
        return 0

    def add_type(parser: ArgumentParser) -> None:
        parser.add_argument("name", metavar=one.upper(), help=f"the {one}")

    def print_type(client: "Client", options: "argparse.Namespace") -> int:
        kind = known(client).get(options.name)
        if kind is not None:
            print(kind)
        return int(kind is None)

    def add_find(parser: ArgumentParser) -> None:
        parser.add_argument("type", metavar="TYPE", help="the type, for example sensor_msgs/msg/JointState")
        add_both(parser)

    def print_found(client: "Client", options: "argparse.Namespace") -> int:
        print_names([name for name, kind in shown(client, options).items() if kind == options.type], options.count)
        return 0

    return {
        "list": Verb(f"list the {noun}", add_list, print_list),
        "type": Verb(f"print the type of one of the {noun}", add_type, print_type),
        "find": Verb(f"list the {noun} of a type", add_find, print_found),
    }


def print_names(names: list[str], only_count: bool) -> None:
    """Print names, or how many there are."""
    for line in [str(len(names))] if only_count else names:
        print(line)
