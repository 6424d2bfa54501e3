"""ROS's command, ``ros2``, in the processes that node programs start: the twin's own tools unless ROS is installed."""

import os
import re
import shutil
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

COMMANDS = ("action", "control", "interface", "node", "param", "service", "topic")  # each a module of drake_twin.tools
_INSTEAD = {
    "bag": "write a bag with --bag FOLDER, and play one with drake-twin play",
    "launch": "give the launch file to the twin, or include it in the one that it has",
    "lifecycle": "call the services of the node by ros2 service call",
    "run": "start the node by --node, or in a launch file",
}
_OTHERS = (*_INSTEAD, "component", "daemon", "doctor", "multicast", "pkg", "security", "test", "wtf")
_FOLDER = str(Path(__file__).parent / "bin")
_COMMAND = re.compile(rf"(?:^|[\s;&|(/])ros2\s+({'|'.join((*COMMANDS, *_OTHERS))})\b")


def with_command(environment: Mapping[str, str]) -> dict[str, str]:
    """Return an environment in which ``ros2`` is found: that of an installed ROS, or else the twin's own."""
    path = os.pathsep.join(filter(None, (environment.get("PATH", os.defpath), _FOLDER)))
    return {**environment, "PATH": path, "DRAKE_TWIN_PYTHON": sys.executable}


def refusal(command: str) -> str:
    """Return that a command of ROS is not there, and what to do instead."""
    what = f"the twin needs no ROS, and 'ros2 {command}' is not there"
    return f"{what}: {_INSTEAD[command]}" if command in _INSTEAD else what


def missing(call: Any, environment: Mapping[str, str], *, has_wires: bool) -> list[str]:
    """Return what of ROS's commands in the call of a process cannot do its work, each with the reason.

    Args:
        call: The text or the words of the call.
        environment: The environment of the process.
        has_wires: Whether the twin is on a graph.
    """
    found = _COMMAND.findall(_text(call))
    if not found or Path(shutil.which("ros2", path=environment.get("PATH")) or _FOLDER).parent != Path(_FOLDER):
        return []
    away = [command for command in COMMANDS if command in found and command != "interface" and not has_wires]
    on_graph = [
        f"'ros2 {command}' finds no twin on the ROS 2 graph: start the twin with --ros zenoh" for command in away
    ]
    return [*on_graph, *(refusal(command) for command in _OTHERS if command in found)]


def _text(call: Any) -> str:
    if isinstance(call, str | bytes | os.PathLike):
        return os.fsdecode(call)
    words = call if isinstance(call, Sequence) else ()
    return " ".join(os.fsdecode(word) for word in words if isinstance(word, str | bytes | os.PathLike))
