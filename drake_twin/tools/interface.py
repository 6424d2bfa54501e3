"""``drake-twin interface``: the types that are known, as ``ros2 interface`` has them."""

import argparse
import sys
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from drake_twin.errors import InputError
from drake_twin.program import ArgumentParser
from drake_twin.tools.verb import Verb, run_verbs

if TYPE_CHECKING:
    from drake_twin.client import Client

_KINDS = {"msg": "Messages", "srv": "Services", "action": "Actions"}
_PARTS = {"msg": ("",), "srv": ("_Request", "_Response"), "action": ("_Goal", "_Result", "_Feedback")}


def _add_kinds(parser: ArgumentParser) -> None:
    for kind, plural in _KINDS.items():
        option = f"--only-{kind}s"
        parser.add_argument(f"-{kind[0]}", option, action="store_true", dest=kind, help=f"only {plural.lower()}")


def _kinds(options: argparse.Namespace) -> list[str]:
    return [kind for kind in _KINDS if getattr(options, kind)] or [*_KINDS]


def _list(client: "Client | None", options: argparse.Namespace) -> int:
    from drake_twin.messages.interface_types import known_names, known_packages

    for kind in _kinds(options):
        print(f"{_KINDS[kind]}:")
        for package in sorted(known_packages()):
            for name in known_names(package, kind):
                print(f"    {package}/{kind}/{name}")
    return 0


def _packages(client: "Client | None", options: argparse.Namespace) -> int:
    from drake_twin.messages.interface_types import known_names, known_packages

    for package in sorted(known_packages()):
        if any(known_names(package, kind) for kind in _kinds(options)):
            print(package)
    return 0


def _add_package(parser: ArgumentParser) -> None:
    parser.add_argument("package_name", metavar="PACKAGE", help="the package, for example sensor_msgs")
    _add_kinds(parser)


def _package(client: "Client | None", options: argparse.Namespace) -> int:
    from drake_twin.messages.interface_types import known_names, known_packages

    if options.package_name not in known_packages():
        name = options.package_name
        raise InputError(f"Unknown package {name!r}", value=name, valid=sorted(known_packages()))
    names = (f"{kind}/{name}" for kind in _kinds(options) for name in known_names(options.package_name, kind))
    for name in sorted(names):
        print(f"{options.package_name}/{name}")
    return 0


def _add_show(parser: ArgumentParser) -> None:
    parser.add_argument("type", metavar="TYPE", help="the type, for example sensor_msgs/msg/JointState")
    for option in ("--all-comments", "--no-comments"):
        parser.add_argument(option, action="store_true", help="as in ROS; there are no comments")


def _show(client: "Client | None", options: argparse.Namespace) -> int:
    for number, part in enumerate(_parts(options.type)):
        if number:
            print("---")
        print(*_lines(part, ""), sep="\n", end="\n" if [*_lines(part, "")] else "")
    return 0


def _parts(kind: str) -> list[str]:
    """Return the names of the messages that a message, service or action is made of.

    Raises:
        InputError: If it is unknown.
    """
    from drake_twin.messages.interface_types import known_names, known_packages, knows

    package, folder, *_ = (*kind.split("/"), "", "")
    if kind.count("/") != 2 or folder not in _KINDS or not knows(f"{kind}{_PARTS[folder][-1]}"):
        valid = [f"{package}/{its}/{known}" for its in _KINDS for known in known_names(package, its)]
        raise InputError(f"Unknown interface {kind!r}", value=kind, valid=valid or sorted(known_packages()))
    return [f"{kind}{part}" for part in _PARTS[folder]]


def _lines(kind: str, indent: str) -> Iterator[str]:
    """Yield the fields of a message, each with the fields of its own messages below it."""
    from drake_twin.messages.interface_types import definition

    for line in definition(kind).partition("=" * 80)[0].splitlines():
        if not line.strip():
            continue
        yield f"{indent}{line}"
        its, _, folder = line.split()[0].partition("[")[0].partition("/")
        if folder and "=" not in line.split()[0]:
            yield from _lines(f"{its}/msg/{folder}", f"{indent}\t")


def _add_proto(parser: ArgumentParser) -> None:
    _add_show(parser)
    parser.add_argument("--no-quotes", action="store_true", help="without quotes around it")


def _proto(client: "Client | None", options: argparse.Namespace) -> int:
    from drake_twin.messages.interface_types import make
    from drake_twin.messages.text import message_text

    text = message_text(make(_parts(options.type)[0], {}), None).removesuffix("---")
    print(text if options.no_quotes else f'"{text}"')
    return 0


VERBS = {
    "list": Verb("list all types", _add_kinds, _list, needs_twin=False),
    "package": Verb("list the types of a package", _add_package, _package, needs_twin=False),
    "packages": Verb("list the packages that have types", _add_kinds, _packages, needs_twin=False),
    "show": Verb("print the fields of a type, without comments", _add_show, _show, needs_twin=False),
    "proto": Verb("print a message or a request with its default values", _add_proto, _proto, needs_twin=False),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program."""
    return run_verbs("interface", VERBS, arguments)


if __name__ == "__main__":
    sys.exit(main())
