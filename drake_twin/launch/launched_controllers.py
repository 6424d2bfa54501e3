"""The controllers that a launch file loads and activates, and the messages that it publishes."""

import shlex
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import yaml

from drake_twin.errors import InputError
from drake_twin.launch.command_line import CommandLine, command_line
from drake_twin.launch.launched import NODE, PROCESS, LaunchedProcess, absolute_name
from drake_twin.scenario import Command

_SPAWNER_FLAGS = (
    *("load-only", "stopped", "inactive", "u", "unload-on-kill", "activate-as-group", "ros-args"),
    *("service-call-timeout", "wait"),
)


@dataclass(frozen=True)
class ControllerRequest:
    """A controller that is to be loaded.

    Attributes:
        name: the controller.
        manager: the full name of the controller manager's node.
        active: whether it is activated, too.
        unload: whether it is taken away instead.
        parameter_files: parameters files given with it.
        process: what asks for it.
    """

    name: str
    manager: str
    active: bool
    process: LaunchedProcess
    unload: bool = False
    parameter_files: tuple[str, ...] = ()


def as_node(process: LaunchedProcess) -> LaunchedProcess:
    """``ros2 run PACKAGE EXECUTABLE …`` as the node that it starts; anything else as it is."""
    words = words_of(process)
    if process.kind != PROCESS or words[:2] != ["ros2", "run"] or len(words) < 4:
        return process
    from dataclasses import replace

    return replace(process, kind=NODE, package=words[2], executable=words[3], arguments=tuple(words[4:]))


def words_of(process: LaunchedProcess) -> list[str]:
    """A command's words, without the shell around them and the full path of the program."""
    words = [process.executable, *process.arguments]
    if len(words) == 1 or (Path(words[0]).name in ("bash", "sh") and "-c" in words):
        try:
            words = shlex.split(words[-1])
        except ValueError:
            words = words[-1].split()
    return [Path(words[0]).name, *words[1:]] if words else [""]


def controller_requests(process: LaunchedProcess) -> list[ControllerRequest] | None:
    """The controllers that a spawner, an unspawner or a ``ros2 control`` command names; None for anything else.

    Raises:
        InputError: a command line that names none.
    """
    if process.package == "controller_manager" and process.executable.split(".")[0] in ("spawner", "unspawner"):
        return _of_spawner(process)
    words = words_of(process)
    if process.kind == PROCESS and words[:2] == ["ros2", "control"] and len(words) > 2:
        return _of_command(process, words[2], words[3:])
    return None


def published_command(process: LaunchedProcess) -> Command | None:
    """What ``ros2 topic pub`` publishes; None for anything else.

    Raises:
        InputError: data that is no YAML.
    """
    words = words_of(process)
    if process.kind != PROCESS or words[:3] != ["ros2", "topic", "pub"]:
        return None
    line = command_line(process, words[3:], flags=("1", "once", "keep-alive"))
    if len(line.words) < 2:
        raise line.error("`ros2 topic pub` needs a topic and a type")
    topic = absolute_name(line.words[0], process.namespace)
    try:
        data = yaml.safe_load(line.words[2]) if len(line.words) > 2 else {}
    except yaml.YAMLError:
        raise line.error(f"{line.words[2]!r} is no YAML") from None
    if isinstance(data, dict) and [*data] == ["data"] and isinstance(data["data"], list):
        data = tuple(float(item) for item in data["data"])
    once = line.flag("1", "once")
    rate = line.number("r", "rate") or 1.0
    return Command(topic, data or {}, process.start_time, None if once else 1.0 / rate)


def _of_spawner(process: LaunchedProcess) -> list[ControllerRequest]:
    line = command_line(process, flags=_SPAWNER_FLAGS)
    names = line.words
    if not names:
        raise line.error("it names no controller")
    return list(
        _requests(
            process,
            names,
            _manager(line, process),
            active=not line.flag("load-only", "stopped", "inactive"),
            unload=process.executable.startswith("unspawner"),
            files=tuple(value for name in ("p", "param-file") for value in line.options.get(name, ())),
        )
    )


def _of_command(process: LaunchedProcess, verb: str, words: list[str]) -> list[ControllerRequest] | None:
    line = command_line(process, words, lists=("activate", "deactivate", "start", "stop"))
    manager = _manager(line, process)
    if verb == "load_controller":
        state = line.text("set-state", "state") or "unconfigured"
        # The state may also stand behind the controller's name, as may its parameters file.
        return list(_requests(process, line.words[:1], manager, active=state in ("active", "start")))
    if verb == "set_controller_state" and len(line.words) >= 2:
        return list(_requests(process, line.words[:1], manager, active=line.words[1] in ("active", "start")))
    if verb in ("switch_controllers", "switch_controller"):
        started = [name for option in ("activate", "start") for name in line.options.get(option, ())]
        stopped = [name for option in ("deactivate", "stop") for name in line.options.get(option, ())]
        return [
            *_requests(process, stopped, manager, active=False),
            *_requests(process, started, manager, active=True),
        ]
    if verb == "unload_controller":
        return list(_requests(process, line.words[:1], manager, active=False, unload=True))
    return None


def _requests(
    process: LaunchedProcess,
    names: Iterable[str],
    manager: str,
    *,
    active: bool,
    unload: bool = False,
    files: tuple[str, ...] = (),
) -> Iterator[ControllerRequest]:
    for name in names:
        yield ControllerRequest(name, manager, active, process, unload, files)


def _manager(line: CommandLine, process: LaunchedProcess) -> str:
    """The controller manager's full name, as the spawner resolves it."""
    name = line.text("c", "controller-manager") or "controller_manager"
    namespace = line.text("n", "namespace") or process.namespace
    return absolute_name(name, "/" + namespace.strip("/"))


def check_parameter_files(request: ControllerRequest) -> InputError | None:
    """The error of a parameters file that is not there; None when all are."""
    place = request.process.place
    for file in request.parameter_files:
        if not Path(file).is_file():
            return InputError(f"the parameters file {file} does not exist", file=place.file, line=place.line)
    return None
