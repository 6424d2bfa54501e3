"""What the tools share: verbs such as ``echo`` with their arguments, and the connection to the twin."""

import os
import queue
import signal
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from drake_twin.dataclass import dataclass
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
        needs_twin: Whether it needs a running twin; `run` gets None for the client where it does not.
    """

    help: str
    add_arguments: Callable[[ArgumentParser], None]
    run: "Callable[[Any, argparse.Namespace], int]"
    needs_twin: bool = True


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
    if verb.needs_twin:
        parser.add_argument(
            "--router",
            metavar="HOST",
            default="127.0.0.1:7447",
            help="the address of the twin or of its Zenoh router, HOST or HOST:PORT (default: %(default)s)",
        )
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")
    options = parser.parse_args(arguments)

    try:
        if not verb.needs_twin:
            return verb.run(None, options)
        from drake_twin.client import Client

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


class Now:
    """The time (ns) by the wall clock, or by the twin's with ``--use-sim-time``.

    Args:
        client: The client.
        options: The arguments.
    """

    def __init__(self, client: "Client", options: "argparse.Namespace") -> None:
        self._simulated: int | None = None
        if options.use_sim_time:
            self._simulated = 0
            client.subscribe("/clock", self._hear)

    @staticmethod
    def add_argument(parser: ArgumentParser) -> None:
        """Add the argument for it."""
        parser.add_argument("-s", "--use-sim-time", action="store_true", help="take the twin's time, not the wall's")

    def _hear(self, message: Any) -> None:
        self._simulated = message.clock.sec * 1_000_000_000 + message.clock.nanosec

    def __call__(self) -> int:
        """Return the time (ns)."""
        return time.time_ns() if self._simulated is None else self._simulated


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
