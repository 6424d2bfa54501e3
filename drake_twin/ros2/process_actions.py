"""Actions that start a process (``launch.actions.ExecuteProcess``)."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_twin.findings import Place
from drake_twin.ros2.entity import Action, as_entities, visit_list
from drake_twin.ros2.events import ExecutionComplete, ProcessExited, ProcessStarted, handle_in
from drake_twin.ros2.launched import PROCESS, LaunchedProcess
from drake_twin.ros2.substitution import SomeSubstitutionsType, normalize_to_list_of_substitutions, perform

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext

# Executables that do their work and end. Everything else keeps running, so that OnProcessExit never fires for it.
_ENDING_NODES = re.compile(
    r"^(create|remove|spawner(\.py)?|unspawner(\.py)?|spawn_entity\.py|hardware_spawner|lifecycle_bringup)$"
    r"|(^|_)(un)?spawn(er)?(_|$|\.py$)|^delete_entity|^load_controller|^set_"
)
_ENDING_ROS2 = ("control", "service", "param", "lifecycle", "pkg", "run", "launch", "node", "interface", "bag")
_ENDING_COMMANDS = {
    *("cat", "chmod", "cp", "date", "echo", "export", "false", "kill", "killall", "ln", "ls", "mkdir", "mv", "pkill"),
    *("printenv", "printf", "rm", "sed", "touch", "true", "which", "xacro"),
}


class Executable:
    """A command line as data (``launch.descriptions.Executable``)."""

    def __init__(
        self,
        *,
        cmd: Iterable[SomeSubstitutionsType],
        prefix: SomeSubstitutionsType | None = None,
        name: SomeSubstitutionsType | None = None,
        cwd: SomeSubstitutionsType | None = None,
        env: Mapping[Any, Any] | None = None,
        additional_env: Mapping[Any, Any] | None = None,
        arguments: Iterable[SomeSubstitutionsType] | None = None,
    ):
        self.cmd = [normalize_to_list_of_substitutions(_text(word)) for word in cmd]
        self.cmd += [normalize_to_list_of_substitutions(_text(word)) for word in arguments or ()]
        self.prefix, self.name, self.cwd = prefix, name, cwd
        self.env, self.additional_env = env, additional_env


class ExecuteLocal(Action):
    """Starts a process.

    Args:
        process_description: its command line.
        shell: whether the words are one shell command.
        output: where its lines go.
        on_exit: actions for when it has ended.
    """

    def __init__(
        self,
        *,
        process_description: Executable,
        shell: bool = False,
        output: Any = "log",
        on_exit: Any = None,
        respawn: Any = False,
        condition: Any = None,
        **ignored: Any,
    ):
        super().__init__(condition=condition)
        self.process_description = process_description
        self.shell = shell
        self.output = output
        self._on_exit = on_exit
        self.respawn = respawn
        self.started: LaunchedProcess | None = None

    @property
    def cmd(self) -> list[Any]:
        """The command line's words, each a list of substitutions."""
        return self.process_description.cmd

    @property
    def name(self) -> str | None:
        """The name of what was started last."""
        return None if self.started is None else self.started.name or self.started.executable

    @property
    def return_code(self) -> int | None:
        """0 once it has been started and ends; None before."""
        return 0 if self.started is not None and self.started.ends else None

    @property
    def process_details(self) -> dict[str, Any] | None:
        """What was started, as ROS describes it."""
        if self.started is None:
            return None
        return {"action": self, "name": self.name or "", "cmd": [self.started.executable, *self.started.arguments]}

    @property
    def what(self) -> str:
        """What it starts, in words."""
        if self.started is not None:
            return self.started.what
        return " ".join("".join(part.describe().strip("'") for part in word) for word in self.cmd)

    def get_sub_entities(self) -> list[Any]:
        """What follows when it has ended."""
        return [] if callable(self._on_exit) else as_entities(self._on_exit)

    def describe_conditional_sub_entities(self) -> list[tuple[str, list[Any]]]:
        """What follows when it has ended."""
        return [("its exit", self.get_sub_entities())] if self._on_exit else []

    def execute(self, context: LaunchContext) -> None:
        """Starts it, and lets the handlers know when it has started and ended."""
        if context.is_shutdown:
            return
        self.started = started = context.start(self.prepare(context))
        captured = context.snapshot()
        details = self.process_details or {}
        context.after(0.0, lambda: handle_in(context, ProcessStarted(**details)))
        if not started.ends:
            return

        def exited() -> None:
            event = ProcessExited(**details)
            if self._on_exit is not None:
                context.run_captured(captured, self.place, lambda: self._follow(event, context))
            handle_in(context, event)
            handle_in(context, ExecutionComplete(action=self))

        context.after(_duration(started), exited)

    def _follow(self, event: ProcessExited, context: LaunchContext) -> None:
        entities = self._on_exit
        if callable(entities) and not hasattr(entities, "visit"):
            entities = entities(event, context)
        visit_list(as_entities(entities), context)

    def prepare(self, context: LaunchContext) -> LaunchedProcess:
        """What it starts, with its substitutions performed."""
        words = [perform(context, word) for word in self.cmd]
        if self.shell:
            words = _split(" ".join(words))
        words = words or [""]
        return LaunchedProcess(
            kind=PROCESS,
            executable=words[0],
            arguments=tuple(words[1:]),
            place=self.place or Place(""),
            name=self._performed(context, self.process_description.name),
            environment=self.own_environment(context),
            output=self.performed_output(context),
            ends=_command_ends(words),
        )

    def own_environment(self, context: LaunchContext) -> dict[str, str | None]:
        """The variables that only this process has."""
        return {
            perform(context, name): perform(context, value)
            for variables in (self.process_description.env, self.process_description.additional_env)
            for name, value in dict(variables or {}).items()
        }

    def performed_output(self, context: LaunchContext) -> str:
        """``screen``, ``log``, ….  Here as text, also where the file gives a mapping."""
        if isinstance(self.output, Mapping):
            return ",".join(f"{perform(context, key)}:{value}" for key, value in self.output.items())
        return perform(context, self.output)

    @staticmethod
    def _performed(context: LaunchContext, subst: Any) -> str | None:
        return None if subst is None else perform(context, subst)


class ExecuteProcess(ExecuteLocal):
    """Starts a command.

    Args:
        cmd: its words.
        prefix, name, cwd, env, additional_env: see `Executable`.
    """

    def __init__(
        self,
        *,
        cmd: Iterable[SomeSubstitutionsType],
        prefix: SomeSubstitutionsType | None = None,
        name: SomeSubstitutionsType | None = None,
        cwd: SomeSubstitutionsType | None = None,
        env: Mapping[Any, Any] | None = None,
        additional_env: Mapping[Any, Any] | None = None,
        **kwargs: Any,
    ):
        if isinstance(cmd, str):
            raise TypeError(f"cmd is a list of words, and {cmd!r} is one text")
        executable = Executable(cmd=cmd, prefix=prefix, name=name, cwd=cwd, env=env, additional_env=additional_env)
        super().__init__(process_description=executable, **kwargs)


def node_ends(executable: str) -> bool:
    """Whether a ROS executable does its work and ends."""
    return _ENDING_NODES.search(executable) is not None


def _command_ends(words: Sequence[str]) -> bool:
    """Whether a command does its work and ends."""
    command, rest = Path(words[0]).name, list(words[1:])
    if command in ("bash", "sh") and rest[:1] == ["-c"] and len(rest) > 1:
        return _command_ends(_split(rest[1].split("&&")[-1].split(";")[-1]) or [""])
    if command == "ros2":
        if rest[:1] == ["run"]:
            return len(rest) > 2 and node_ends(rest[2])
        if rest[:2] == ["topic", "pub"]:
            return any(word in ("-1", "--once", "-t", "--times") for word in rest)
        return bool(rest) and rest[0] in _ENDING_ROS2 and rest[:1] not in (["launch"], ["bag"])
    if command in ("gz", "ign"):
        return rest[:1] in (["service"], ["model"], ["topic"], ["param"], ["log"]) and "-e" not in rest
    return command in _ENDING_COMMANDS or command == "sleep" or node_ends(command)


def _duration(process: LaunchedProcess) -> float:
    """How long a process that ends takes (simulated s): nothing, unless it is ``sleep``."""
    if Path(process.executable).name == "sleep" and process.arguments:
        try:
            return float(process.arguments[0].rstrip("s"))
        except ValueError:
            return 0.0
    return 0.0


def _split(line: str) -> list[str]:
    try:
        return shlex.split(line)
    except ValueError:  # an unbalanced quote is the shell's business
        return line.split()


def _text(word: Any) -> Any:
    return str(word) if isinstance(word, bool | int | float) else word
