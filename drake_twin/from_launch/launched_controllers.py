"""The controllers that a launch file loads and activates, and the messages that it publishes."""

import contextlib
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import yaml

from drake_twin.dataclass import dataclass
from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.errors import InputError
from drake_twin.from_launch.command_line import CommandLine, command_line
from drake_twin.from_launch.gz_service import as_create
from drake_twin.ros2.launched import NODE, PROCESS, LaunchedProcess, absolute_name, joined_namespace
from drake_twin.ros2.ros_arguments import split_ros_arguments
from drake_twin.scenario import Command

_SPAWNER_FLAGS = (
    *("load-only", "stopped", "inactive", "u", "unload-on-kill", "activate-as-group", "ros-args"),
    *("switch-asap", "no-switch-asap"),
)
_SPAWNER_VALUES = (
    *("c", "controller-manager", "n", "namespace", "p", "param-file", "t", "controller-type", "controller-ros-args"),
    *("controller-manager-timeout", "switch-timeout", "service-call-timeout", "controller"),
    *("r", "remap", "params-file", "log-level"),  # after --ros-args
)
_COMMAND_FLAGS = ("strict", "best-effort", "asap", "s", "use-sim-time", "include-hidden-nodes")
_PUB_FLAGS = ("1", "once", "s", "use-sim-time", "no-daemon")

_MOST_TIMES = 1000

ACTIVE, INACTIVE, UNCONFIGURED = "active", "inactive", "unconfigured"

_CONNECTIVES = ("&&", "||", ";", "&", "|")
_OF_THE_SHELL = ("source", ".", "cd", "export", "echo", "true", "wait", "exit")


@dataclass(frozen=True)
class ControllerRequest:
    """A request to load or unload a controller.

    Attributes:
        name: The controller.
        manager: The full name of the controller manager's node.
        state: The state to bring it to: active, inactive or unconfigured.
        unload: Whether it is unloaded instead.
        parameter_files: The parameters files given with it.
        remappings: Pairs (from, to) as written, for the controller's own names.
        process: The process that makes the request.
        parameters: Parameters given on the command line; ``type`` is the controller's type.
        group: Whether all controllers of the process are activated or none.
    """

    name: str
    manager: str
    state: str
    process: LaunchedProcess
    unload: bool = False
    parameter_files: tuple[str, ...] = ()
    remappings: tuple[tuple[str, str], ...] = ()
    parameters: Mapping[str, Any] = field(default_factory=dict)
    group: bool = False


def as_nodes(process: LaunchedProcess) -> Iterator[LaunchedProcess]:
    """Yield the commands of a shell's line, with ``ros2 run PACKAGE EXECUTABLE …`` as the node that it starts.

    A call of Gazebo's service ``create`` is the node that does the same.
    """
    words = words_of(process) if process.kind == PROCESS else []
    parts: list[list[str]] = [[]]
    for word in words:
        if word not in _CONNECTIVES:
            parts[-1].append(word.rstrip(";") or word)
        if word in _CONNECTIVES or word.endswith(";"):
            parts.append([])
    parts = [part for part in parts if part]
    if len(parts) < 2:
        yield _as_node(process)
        return
    time = process.start_time
    for part in parts:
        if part[0] == "sleep":
            with contextlib.suppress(ValueError):
                time += float(part[-1].rstrip("s"))
        elif part[0] not in _OF_THE_SHELL:
            yield _as_node(replace(process, executable=part[0], arguments=tuple(part[1:]), start_time=time))


def _as_node(process: LaunchedProcess) -> LaunchedProcess:
    words = words_of(process)
    if process.kind != PROCESS:
        return process
    if (create := as_create(process, words)) is not None:
        return create
    if words[:2] != ["ros2", "run"] or len(words) < 4:
        return process
    said = split_ros_arguments(words[4:])
    return replace(
        process,
        kind=NODE,
        package=words[2],
        executable=words[3],
        name=said.name,
        namespace=joined_namespace(None, said.namespace),
        parameters=said.parameters,
        remappings=said.remappings,
        arguments=said.arguments,
    )


def words_of(process: LaunchedProcess) -> list[str]:
    """Return a command's words, without the shell and without the program's folder."""
    words = [process.executable, *process.arguments]
    if len(words) == 1 or (Path(words[0]).name in ("bash", "sh") and "-c" in words):
        try:
            words = shlex.split(words[-1])
        except ValueError:
            words = words[-1].split()
    return [Path(words[0]).name, *words[1:]] if words else [""]


def controller_requests(process: LaunchedProcess) -> list[ControllerRequest] | None:
    """Return the controllers that a spawner, an unspawner or a ``ros2 control`` command names; None for anything else.

    Raises:
        InputError: If the command line has no controller.
    """
    if process.package == "controller_manager" and process.executable.split(".")[0] in ("spawner", "unspawner"):
        return _of_spawner(process)
    words = words_of(process)
    if process.kind == PROCESS and words[:2] == ["ros2", "control"] and len(words) > 2:
        return _of_command(process, words[2], words[3:])
    return None


def published_commands(process: LaunchedProcess) -> list[Command] | None:
    """Return the commands that ``ros2 topic pub`` publishes; None for any other process.

    Raises:
        InputError: If a topic is missing, a rate is not positive, or data is not a message.
    """
    words = words_of(process)
    if process.kind != PROCESS or words[:3] != ["ros2", "topic", "pub"]:
        return None
    line = command_line(process, words[3:], flags=_PUB_FLAGS)
    if len(line.words) < 2:
        raise line.error("`ros2 topic pub` needs a topic and a type")
    topic = absolute_name(line.words[0], process.namespace)
    data = _message(line, line.words[2] if len(line.words) > 2 else "{}")
    rate = line.number("r", "rate") if line.text("r", "rate") is not None else 1.0
    if not rate > 0:
        raise line.error(f"a rate of {rate:g} Hz is invalid: it must be positive")
    times = 1 if line.flag("1", "once") else int(line.number("t", "times"))
    if not 0 < times <= _MOST_TIMES:  # none given, or practically infinite
        return [Command(topic, data, process.start_time, 1.0 / rate, optional=True)]
    return [Command(topic, data, process.start_time + index / rate, optional=True) for index in range(times)]


def _message(line: CommandLine, text: str) -> tuple[float, ...] | dict[str, Any]:
    """Return the numbers of a ``Float64MultiArray``, or any message's fields."""
    try:
        data = load_yaml(text)
    except yaml.YAMLError:
        raise line.error(f"{text!r} is not valid YAML") from None
    if data is None:
        return {}
    if not isinstance(data, dict):
        raise line.error(f"{text!r} is not the fields of a message, such as '{{data: [1.0]}}'")
    if [*data] != ["data"] or not isinstance(data["data"], list):
        return data
    try:
        return tuple(float(item) for item in data["data"])
    except (TypeError, ValueError, OverflowError):
        raise line.error(f"{text!r}: the data must all be numbers") from None


def _of_spawner(process: LaunchedProcess) -> list[ControllerRequest]:
    line = _spawner_line(process, process.arguments)
    unknown = [name for name in line.options if not _is_spawner_option(name)]
    if unknown:
        known = ", ".join(f"--{name}" for name in (*_SPAWNER_FLAGS, *_SPAWNER_VALUES) if len(name) > 1)
        raise line.error(f"unknown option --{unknown[0]}. Valid: {known}")
    if "controller" not in line.options:
        if not line.words:
            raise line.error("it has no controller")
        return [_spawned(process, name, line, line) for name in line.words]
    words = list(process.arguments)
    starts = [index for index, word in enumerate(words) if word.partition("=")[0] == "--controller"]
    requests = []
    for start, end in pairwise((*starts, len(words))):
        own = _spawner_line(process, words[start:end])
        (name,) = own.options["controller"]
        if name == "true":
            raise line.error("--controller needs the name of a controller")
        requests.append(_spawned(process, name, own, line))
    return requests


def _spawner_line(process: LaunchedProcess, words: Sequence[str]) -> CommandLine:
    return command_line(process, words, flags=_SPAWNER_FLAGS, verbatim=("controller-ros-args",))


def _is_spawner_option(name: str) -> bool:
    """Return whether a spawner has an option; a long one may be abbreviated."""
    known = (*_SPAWNER_FLAGS, *_SPAWNER_VALUES, "h", "help")
    return name in known or (len(name) > 1 and any(option.startswith(name) for option in known))


def _spawned(process: LaunchedProcess, name: str, own: CommandLine, line: CommandLine) -> ControllerRequest:
    """Return the request for one controller from its own options and those of the spawner."""
    ros_words = [word for text in own.options.get("controller-ros-args", ()) for word in shlex.split(text)]
    said = split_ros_arguments(["--ros-args", *(word for word in ros_words if word != "--ros-args")])
    kind = own.text("t", "controller-type")
    parameters: dict[str, Any] = {} if kind is None else {"type": kind}
    for item in said.parameters:
        parameters |= item if isinstance(item, Mapping) else {}
    inactive = own.flag("stopped", "inactive")
    files = tuple(value for option in ("p", "param-file") for value in own.options.get(option, ()))
    return ControllerRequest(
        name,
        _manager(line, process),
        UNCONFIGURED if own.flag("load-only") else INACTIVE if inactive else ACTIVE,
        process,
        process.executable.startswith("unspawner"),
        (*files, *(str(item) for item in said.parameters if isinstance(item, Path))),
        said.remappings,
        parameters,
        line.flag("activate-as-group"),
    )


def _of_command(process: LaunchedProcess, verb: str, words: list[str]) -> list[ControllerRequest] | None:
    lists = [f"{verb}{rest}" for verb in ("activate", "deactivate", "start", "stop") for rest in ("", "-controllers")]
    line = command_line(process, words, flags=_COMMAND_FLAGS, lists=lists)
    manager, names = _manager(line, process), line.words[:1]

    def requests(names: Iterable[str], state: str, **more: Any) -> list[ControllerRequest]:
        return [ControllerRequest(name, manager, state, process, **more) for name in names]

    def after(*options: str) -> Iterator[str]:
        for option in options:
            yield from (*line.options.get(option, ()), *line.options.get(f"{option}-controllers", ()))

    if verb == "load_controller":
        wanted = line.text("set-state", "state")
        state = UNCONFIGURED if wanted is None else _state(wanted)
        return requests(names, state, parameter_files=line.words[1:2])
    if verb in ("load_start_controller", "load_configure_controller"):  # ROS 2 Foxy's
        return requests(names, ACTIVE if verb == "load_start_controller" else INACTIVE)
    if verb == "set_controller_state" and len(line.words) >= 2:
        return requests(names, _state(line.words[1]))
    if verb in ("switch_controllers", "switch_controller"):
        return requests(after("deactivate", "stop"), INACTIVE) + requests(after("activate", "start"), ACTIVE)
    if verb == "unload_controller":
        return requests(names, INACTIVE, unload=True)
    return None


def _state(word: str) -> str:
    return ACTIVE if word in ("active", "start") else INACTIVE


def _manager(line: CommandLine, process: LaunchedProcess) -> str:
    """Return the controller manager's full name, as the spawner resolves it."""
    name = line.text("c", "controller-manager") or "controller_manager"
    namespace = line.text("n", "namespace") or process.namespace
    return absolute_name(name, "/" + namespace.strip("/"))


def check_parameter_files(request: ControllerRequest) -> InputError | None:
    """Return the error of the first missing parameters file; None if all exist."""
    for file in request.parameter_files:
        if not Path(file).is_file():
            return request.process.error(f"the parameters file {file} does not exist")
    return None
