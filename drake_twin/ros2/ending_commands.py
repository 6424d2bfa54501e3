"""Which programs do their work and end, and which keep running."""

import re
import shlex
from collections.abc import Sequence
from pathlib import Path

from drake_twin.ros2.launched import LaunchedProcess

# Executables that do their work and end. Everything else keeps running, so that OnProcessExit never fires for it.
_ENDING_NODES = re.compile(
    r"^(create|remove|spawner(\.py)?|unspawner(\.py)?|spawn_entity\.py|hardware_spawner|lifecycle_bringup)$"
    r"|(^|_)(un)?spawn(er)?(_|$|\.py$)|^delete_entity|^load_controller|^set_|^wait_(for|until)_|\.(ba)?sh$"
)
_ENDING_ROS2 = ("control", "service", "param", "lifecycle", "pkg", "run", "launch", "node", "interface", "bag")
_ENDING_COMMANDS = {
    *("cat", "chmod", "cp", "date", "echo", "export", "false", "kill", "killall", "ln", "ls", "mkdir", "mv", "pkill"),
    *("printenv", "printf", "rm", "sed", "touch", "true", "which", "xacro"),
}


def node_ends(executable: str) -> bool:
    """Return whether a ROS executable does its work and ends."""
    return _ENDING_NODES.search(executable) is not None


def command_ends(words: Sequence[str]) -> bool:
    """Return whether a command does its work and ends."""
    command, rest = Path(words[0]).name, list(words[1:])
    if command in ("bash", "sh") and rest[:1] == ["-c"] and len(rest) > 1:
        return command_ends(shell_words(rest[1].split("&&")[-1].split(";")[-1]) or [""])
    if command in ("bash", "sh") and rest:
        return node_ends(Path(next((word for word in rest if not word.startswith("-")), "")).name)
    if command == "ros2":
        if rest[:1] == ["run"]:
            return len(rest) > 2 and node_ends(rest[2])
        if rest[:2] == ["topic", "pub"]:
            return any(word in ("-1", "--once", "-t", "--times") for word in rest)
        return bool(rest) and rest[0] in _ENDING_ROS2 and rest[:1] not in (["launch"], ["bag"])
    if command in ("gz", "ign"):
        return rest[:1] in (["service"], ["model"], ["topic"], ["param"], ["log"]) and "-e" not in rest
    return command in _ENDING_COMMANDS or command == "sleep" or node_ends(command)


def duration(process: LaunchedProcess) -> float:
    """Return how long a process that ends takes (simulated s): 0, unless it is ``sleep``."""
    if Path(process.executable).name == "sleep" and process.arguments:
        try:
            return float(process.arguments[0].rstrip("s"))
        except ValueError:
            return 0.0
    return 0.0


def shell_words(line: str) -> list[str]:
    """Split a shell's command line into words."""
    try:
        return shlex.split(line)
    except ValueError:  # an unbalanced quote is the shell's business
        return line.split()
