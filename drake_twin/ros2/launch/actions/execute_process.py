"""Starts a command."""

from collections.abc import Iterable, Mapping
from typing import Any

from drake_twin.ros2.command_lines import split_command_line
from drake_twin.ros2.launch.actions.execute_local import ExecuteLocal
from drake_twin.ros2.launch.actions.shutdown_action import Shutdown
from drake_twin.ros2.launch.descriptions.executable import Executable
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType

# What ROS knows and the twin ignores, with the types: it starts no process.
_IGNORED = {
    **dict.fromkeys(("sigkill_timeout", "sigterm_timeout"), str),
    "emulate_tty": bool,
    "log_cmd": bool,
    "cached_output": bool,
}


@expose_action("executable")
class ExecuteProcess(ExecuteLocal):
    """Starts a command.

    Args:
        cmd: Its words.
        prefix: See `Executable`, as the next four.
        name: The process's name.
        cwd: Its working directory.
        env: Its environment variables.
        additional_env: Environment variables beside the present ones.
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
        executable = Executable(cmd=cmd, prefix=prefix, name=name, cwd=cwd, env=env, additional_env=additional_env)
        super().__init__(process_description=executable, **kwargs)

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<executable>``."""
        _, arguments = super().parse(entity, parser)
        shell = entity.get_flag("shell")
        cmd = split_command_line(parser.parse_required(entity, "cmd")["cmd"])
        name = parser.parse_optional(entity, "name")
        return cls, {**arguments, **process_arguments(entity, parser), **name, "cmd": cmd, "shell": bool(shell)}


def process_arguments(entity: Entity, parser: Parser) -> dict[str, Any]:
    """Return the arguments of an action that starts a process, apart from its command and its name."""
    for name, data_type in _IGNORED.items():
        entity.get_attr(name, data_type=data_type, optional=True)
    arguments: dict[str, Any] = dict(parser.parse_optional(entity, "cwd", "output", "respawn"))
    for name, data_type in (("respawn_delay", float), ("respawn_max_retries", int)):
        value = entity.get_attr(name, data_type=data_type, optional=True)
        arguments |= {} if value is None else {name: value}
    prefix = parser.parse_optional(entity, "launch-prefix")
    if prefix:
        arguments["prefix"] = prefix["launch_prefix"]
    variables = parser.parse_children(entity, "env", "name", "value")
    if variables:
        arguments["additional_env"] = {tuple(variable["name"]): variable["value"] for variable in variables}
    if entity.get_attr("on_exit", optional=True) == "shutdown":
        arguments["on_exit"] = [Shutdown()]
    return arguments
