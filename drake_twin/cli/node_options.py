"""The option ``--node``: users' rclpy programs beside the robots."""

import argparse
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from drake_twin.description.package_index import absolute_path
from drake_twin.errors import InputError
from drake_twin.program import add_repeated, say
from drake_twin.scenario import NodeProgram

if TYPE_CHECKING:
    from drake_twin.nodes.nodes import Nodes
    from drake_twin.twin.twin import Twin


def add_node_option(group: argparse._ArgumentGroup) -> None:
    """Add the option."""
    what = "run a Python node of yours in lock-step with the simulation"
    add_repeated(group, "--node", "'SCRIPT ARGUMENTS'", f"{what}; 'PACKAGE PROGRAM ARGUMENTS' is one of a package")


def node_programs(lines: Sequence[str]) -> tuple[NodeProgram, ...]:
    """Return the programs of ``--node``.

    Raises:
        InputError: If a command line is empty or has an open quote, or the script does not exist.
    """
    return tuple(_node_program(line) for line in lines)


def _node_program(line: str) -> NodeProgram:
    whole = Path(absolute_path(line))
    if whole.is_file():  # a path with spaces
        return NodeProgram(str(whole))
    try:
        words = shlex.split(line)
    except ValueError as error:
        raise InputError(f"--node {line!r}: {error}") from None
    if not words:
        raise InputError("--node needs a script, or a package and its program")
    file = Path(absolute_path(words[0]))
    if file.is_file():
        return NodeProgram(str(file), arguments=tuple(words[1:]))
    if len(words) < 2 or "/" in words[0] or words[0].endswith(".py"):
        raise InputError(f"--node {line!r}: the script does not exist", file=file)
    return NodeProgram(words[1], words[0], tuple(words[2:]))


def start_nodes(twin: "Twin", stopped: Sequence[int], *, again: bool) -> "Nodes | None":
    """Start the nodes of a twin, and say so where they cannot continue where they were.

    Args:
        twin: The twin.
        stopped: The signals that have arrived.
        again: Whether the twin continues a run that was saved.
    """
    if not twin.scenario.nodes:
        return None
    from drake_twin.services.node_programs import start_nodes

    nodes = start_nodes(twin, lambda: bool(stopped))
    assert nodes is not None
    nodes.on_shutdown = twin.pause
    if again:
        names = ", ".join(node.what for node in twin.scenario.nodes)
        say(f"nodes: what is saved has no nodes inside: {names} start again at {twin.time:.3f} s", sys.stderr)
    return nodes


def end_of_launch(nodes: "Nodes") -> bool:
    """Return whether the end of a node has ended the launch, and with it the run; say so."""
    if nodes.shutdown_reason is not None:
        say(f"shutdown: {nodes.shutdown_reason}")
    return nodes.shutdown_reason is not None
