"""Starts a process."""

from collections.abc import Iterable, Mapping
from typing import Any

from drake_twin.errors import did_you_mean
from drake_twin.findings import Place
from drake_twin.ros2.ending_commands import command_ends, duration, shell_words
from drake_twin.ros2.event_effects import emit
from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.descriptions.executable import Executable
from drake_twin.ros2.launch.events.execution_complete import ExecutionComplete
from drake_twin.ros2.launch.events.process import ProcessExited, ProcessStarted
from drake_twin.ros2.launch.launch_context import Lasting, LaunchContext
from drake_twin.ros2.launch.utilities.normalize_to_list_of_entities_impl import normalize_to_list_of_entities
from drake_twin.ros2.launched import (
    PROCESS,
    LaunchedProcess,
)
from drake_twin.ros2.visiting import visit_list
from drake_twin.ros2.without_effect import parameters_without_effect

_IGNORED = parameters_without_effect("launch.actions.ExecuteLocal")
_USED = (
    *("package", "executable", "name", "namespace", "parameters", "remappings", "arguments", "ros_arguments", "cmd"),
    *("output", "on_exit", "respawn", "respawn_delay", "respawn_max_retries"),
    *("condition", "prefix", "cwd", "env", "additional_env", "shell"),
)


class ExecuteLocal(Action):
    """Starts a process.

    Args:
        process_description: Its command line.
        shell: Whether the words are one shell command.
        output: Where its lines go.
        on_exit: Actions for when it has ended.
        respawn: Whether it is to be started again when it ends.
        respawn_delay: How long after its end (s).
        respawn_max_retries: How often at most; negative for no end.
        condition: A condition, or None.
    """

    def __init__(
        self,
        *,
        process_description: Executable,
        shell: bool = False,
        output: Any = "log",
        on_exit: Any = None,
        respawn: Any = False,
        respawn_delay: float | None = None,
        respawn_max_retries: int = -1,
        condition: Any = None,
        **kwargs: Any,
    ):
        refuse_unknown_keywords(type(self).__name__, kwargs, _IGNORED)
        super().__init__(condition=condition)
        self.process_description = process_description
        self.shell = shell
        self.output = output
        self._on_exit = on_exit
        self.respawn, self._respawn_delay, self._respawn_max_retries = respawn, respawn_delay, respawn_max_retries
        self._return_code: int | None = None
        self.started: LaunchedProcess | None = None

    @property
    def cmd(self) -> list[Any]:
        """The command line's words, each a list of substitutions."""
        return self.process_description.cmd

    @property
    def name(self) -> str | None:
        """The name of the process that was started last."""
        return None if self.started is None else self.started.name or self.started.executable

    @property
    def return_code(self) -> int | None:
        """The exit code once the process has ended; None before."""
        return 0 if self.started is not None and self.started.ends else self._return_code

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
        """Return what follows when the process has ended."""
        return [] if callable(self._on_exit) else normalize_to_list_of_entities(self._on_exit)

    def describe_conditional_sub_entities(self) -> list[tuple[str, list[Any]]]:
        """Return what follows when the process has ended."""
        return [("its exit", self.get_sub_entities())] if self._on_exit else []

    def execute(self, context: LaunchContext) -> None:
        """Start the process, and emit events for its start and its end."""
        if context.is_shutdown:
            return
        for word in self.process_description.numbers:
            context.refused_by_ros(f"{word!r} in a command line is not text")
        if self.process_description.single_text:
            text = self.process_description.single_text
            context.log.append(f"{text!r} is one text and not a list of words: ROS takes each letter for a word")
        self.started = started = context.start(self.prepare(context))
        captured = context.snapshot()
        details = self.process_details or {}
        context.events.after(0.0, lambda: emit(context, ProcessStarted(**details)))

        def exited(returncode: int = 0) -> None:
            self._return_code = returncode
            event = ProcessExited(returncode=returncode, **details)
            if self._on_exit is not None:
                context.run_captured(captured, self.place, lambda: self._follow(event, context))
            emit(context, event)
            emit(context, ExecutionComplete(action=self))

        if started.ends:
            context.events.after(duration(started), exited)
        else:
            context.lasting[started.key] = Lasting(exited, self._on_exit is not None)

    def _follow(self, event: ProcessExited, context: LaunchContext) -> None:
        entities = self._on_exit
        if callable(entities) and not hasattr(entities, "visit"):
            entities = entities(event, context)
        visit_list(normalize_to_list_of_entities(entities), context)

    def prepare(self, context: LaunchContext) -> LaunchedProcess:
        """Return what it starts, with its substitutions performed."""
        words = [context.perform_substitution(word) for word in self.cmd]
        if self.shell:
            words = shell_words(" ".join(words))
        words = words or [""]
        return LaunchedProcess(
            kind=PROCESS,
            executable=words[0],
            arguments=tuple(words[1:]),
            place=self.place or Place(""),
            name=performed(context, self.process_description.name),
            environment=self.own_environment(context),
            output=self.performed_output(context),
            ends=command_ends(words),
            not_done=self.not_done(context),
            respawn=self.performed_respawn(context),
        )

    def not_done(self, context: LaunchContext) -> tuple[str, ...]:
        """Return the keywords of what it asks for and the twin does for no process."""
        described = self.process_description
        given = {"cwd": described.cwd, "prefix": described.prefix}
        return tuple(name for name, value in given.items() if value is not None and context.perform_substitution(value))

    def performed_respawn(self, context: LaunchContext) -> tuple[float, int] | None:
        """Return the delay and the number of times after which a process that has ended starts again; None if never."""
        respawn = self.respawn if isinstance(self.respawn, bool) else context.perform_substitution(self.respawn)
        if str(respawn).lower() not in ("true", "1"):
            return None
        return max(0.0, float(self._respawn_delay or 0.0)), int(self._respawn_max_retries)

    def own_environment(self, context: LaunchContext) -> dict[str, str | None]:
        """Return the variables that only this process has."""
        return {
            context.perform_substitution(name): context.perform_substitution(value)
            for variables in (self.process_description.env, self.process_description.additional_env)
            for name, value in dict(variables or {}).items()
        }

    def performed_output(self, context: LaunchContext) -> str:
        """Return ``screen``, ``log``, …; as text also where the file gives a mapping."""
        if isinstance(self.output, Mapping):
            return ",".join(f"{context.perform_substitution(key)}:{value}" for key, value in self.output.items())
        return context.perform_substitution(self.output)


def refuse_unknown_keywords(what: str, given: Iterable[str], known: Iterable[str]) -> None:
    """Refuse keyword arguments that ROS refuses, too: one that is misspelt would be lost.

    Raises:
        TypeError: If one is not known.
    """
    known = list(known)
    for name in given:
        if name not in known:
            hint = did_you_mean(name, [*known, *_USED])
            raise TypeError(f"{what} got an unexpected keyword argument {name!r}{hint}")


def performed(context: LaunchContext, subst: Any) -> str | None:
    """Return the text of a substitution; None for None."""
    return None if subst is None else context.perform_substitution(subst)
