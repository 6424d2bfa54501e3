"""What the tools share: verbs such as ``echo`` with their arguments, and the connection to the twin."""

import os
import queue
import signal
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from drake_twin.errors import InputError
from drake_twin.program import ArgumentParser, run_program

if TYPE_CHECKING:
    import argparse

    from drake_twin.client import Client

_MOST_WAITING = 1000


@dataclass(frozen=True)
class Verb:
    """What a tool can do.

    Attributes:
        help: What it does, in one line.
        add_arguments: Adds its arguments to a parser.
        run: Does it with a client and the arguments, and returns the exit code.
    """

    help: str
    add_arguments: Callable[[ArgumentParser], None]
    run: "Callable[[Client, argparse.Namespace], int]"


def listing(noun: str, known: "Callable[[Client], Mapping[str, str]]") -> Verb:
    """Return the verb ``list``.

    Args:
        noun: What it lists, in the plural.
        known: Returns what there is, each with its type.
    """

    def add_arguments(parser: ArgumentParser) -> None:
        parser.add_argument("-t", "--show-types", action="store_true", help="show the types, too")
        parser.add_argument(
            "-c", f"--count-{noun}", dest="count", action="store_true", help="print only how many there are"
        )
        parser.add_argument(
            f"--include-hidden-{noun}", dest="hidden", action="store_true", help="list those of actions, too"
        )

    def run(client: "Client", options: "argparse.Namespace") -> int:
        found = {name: kind for name, kind in known(client).items() if options.hidden or "/_" not in name}
        if options.count:
            print(len(found))
            return 0
        for name, kind in found.items():
            print(f"{name} [{kind}]" if options.show_types else name)
        return 0

    return Verb(f"list the {noun}", add_arguments, run)


def run_verbs(tool: str, verbs: Mapping[str, Verb], arguments: Sequence[str] | None) -> int:
    """Run the verb that the first argument names; see `drake_twin.program.run_program`."""

    def program(words: Sequence[str]) -> int:
        name = words[0] if words else "--help"
        if name in ("-h", "--help"):
            print(f"usage: drake-twin {tool} VERB …   (drake-twin {tool} VERB --help explains it)\n")
            print("\n".join(f"  {verb:24} {of_it.help}" for verb, of_it in verbs.items()))
            return 0
        if name not in verbs:
            raise InputError(f"drake-twin {tool} has no verb {name!r}", value=name, valid=verbs)
        return _run(f"{tool} {name}", verbs[name], words[1:])

    return run_program(program, arguments)


def run_verb(tool: str, verb: Verb, arguments: Sequence[str] | None) -> int:
    """Run a tool that does one thing; see `drake_twin.program.run_program`."""
    return run_program(lambda words: _run(tool, verb, words), arguments)


def _run(name: str, verb: Verb, arguments: Sequence[str]) -> int:
    if signal.getsignal(signal.SIGINT) is signal.SIG_DFL:  # of `drake_twin.__main__`
        signal.signal(signal.SIGINT, signal.default_int_handler)
    parser = ArgumentParser(prog=f"drake-twin {name}", description=f"{verb.help[0].upper()}{verb.help[1:]}.")
    verb.add_arguments(parser)
    parser.add_argument(
        "--router",
        metavar="HOST",
        default="127.0.0.1:7447",
        help="the address of the twin or of its Zenoh router, HOST or HOST:PORT (default: %(default)s)",
    )
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")
    options = parser.parse_args(arguments)
    from drake_twin.client import Client

    try:
        with Client(options.router) as client:
            return verb.run(client, options)
    except BrokenPipeError:  # of `| head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


class Arrivals:
    """Messages on their way from Zenoh's threads to the main one; where that is too slow, the newest are lost.

    Attributes:
        lost: How many have been lost.
    """

    def __init__(self) -> None:
        self._items: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self.lost = 0

    def put(self, item: Any) -> None:
        """Add a message."""
        if self._items.qsize() < _MOST_WAITING:
            self._items.put(item)
        else:
            self.lost += 1

    def get(self, timeout: float) -> Any:
        """Wait for a message (s), and return it; None if it does not come."""
        try:
            return self._items.get(timeout=max(0.0, timeout))
        except queue.Empty:
            return None

    def __iter__(self) -> Iterator[Any]:
        """Yield messages for ever."""
        while True:
            yield self._items.get()


def yaml_values(text: str) -> Any:
    """Return the data in a YAML text of the command line.

    Raises:
        InputError: If it is not valid YAML.
    """
    import yaml

    from drake_twin.description.bounded_yaml import load_yaml

    try:
        return load_yaml(text)
    except yaml.YAMLError as error:
        reason = " ".join(str(error).split())
        raise InputError(f"{text!r} is not valid YAML: {reason}") from None


def positive(text: str) -> float:
    """Read a positive number, for an argument parser."""
    number = float(text)
    if not 0 < number < float("inf"):
        raise ValueError
    return number
