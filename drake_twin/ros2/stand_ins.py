"""Launch files of packages that only ROS has: simulators, and what is of no use without ROS."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.ros2.launched import NODE, WORLD, LaunchArgument, LaunchedProcess, WorldStart
from drake_twin.ros2.packages import BUILT_IN

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext

_TRUE = ("true", "1")


@dataclass(frozen=True)
class StandIn:
    """A launch file that the twin stands in for.

    Attributes:
        arguments: its arguments and their defaults; "" where ROS's file computes one.
        start: what including it does.
    """

    arguments: Mapping[str, str]
    start: Callable[[Mapping[str, str], LaunchContext, LaunchedProcess], None]


def world_of_gz_args(gz_args: str, arguments: Mapping[str, str] | None = None) -> WorldStart:
    """The world that gz's command line asks for.

    Args:
        gz_args: such as ``-r -v 4 empty.sdf``.
        arguments: the stand-in launch file's arguments, to keep.
    """
    try:
        words = shlex.split(gz_args)
    except ValueError as error:
        raise InputError(f"gz_args is {gz_args!r}, which cannot be split into words ({error})") from None
    world, running, server, window, verbosity = None, False, False, False, 1
    position = 0
    while position < len(words):
        word = words[position]
        name, equals, value = word.partition("=")
        position += 1
        if name in ("-v", "--verbose"):
            follows = value if equals else (words[position] if position < len(words) else "")
            if follows.isdigit():
                verbosity = int(follows)
                position += 0 if equals else 1
            else:
                verbosity = 3  # as gz takes a bare -v
        elif name[:2] == "-v" and name[2:].isdigit():
            verbosity = int(name[2:])
        elif name in _OPTIONS_WITH_VALUE:
            position += 0 if equals else 1
        elif name.startswith("--"):
            server = server or name == "--headless-rendering"
            running = running or name == "--run"
        elif name.startswith("-"):
            running, server, window = running or "r" in name, server or "s" in name, window or "g" in name
        elif word not in ("gz", "ign", "sim", "gazebo"):
            world = world or word
    return WorldStart(
        "gz",
        world,
        paused=not running,
        verbosity=verbosity,
        server_only=server,
        window_only=window and not server,
        arguments=dict(arguments or {}),
    )


_OPTIONS_WITH_VALUE = (
    *("-z", "--update-rate", "--iterations", "--levels", "--network-role", "--network-secondaries", "--record-path"),
    *("--seed", "--gui-config", "--physics-engine", "--render-engine", "--render-engine-gui", "--playback"),
    *(
        "--render-engine-server",
        "--force-version",
        "--initial-sim-time",
        "--record-topic",
        "--render-engine-gui-api-backend",
    ),
)


def _gz_sim(arguments: Mapping[str, str], context: LaunchContext, process: LaunchedProcess) -> None:
    text = f"{arguments.get('gz_args') or arguments.get('ign_args', '')}"
    _start_world(context, process, world_of_gz_args(text, arguments))


def _gz_server(arguments: Mapping[str, str], context: LaunchContext, process: LaunchedProcess) -> None:
    world = arguments.get("world_sdf_file") or arguments.get("world_sdf_string") or None
    _start_world(context, process, WorldStart("gz", world, server_only=True, arguments=dict(arguments)))


def _ros_gz_sim(arguments: Mapping[str, str], context: LaunchContext, process: LaunchedProcess) -> None:
    _gz_server(arguments, context, process)
    _start_bridge(arguments, context, process)


def _ros_gz_spawn_model(arguments: Mapping[str, str], context: LaunchContext, process: LaunchedProcess) -> None:
    _start_bridge(arguments, context, process)
    _spawn_model(arguments, context, process)


def _start_bridge(arguments: Mapping[str, str], context: LaunchContext, process: LaunchedProcess) -> None:
    config = arguments.get("config_file", "")
    _start_node(
        context,
        process,
        package="ros_gz_bridge",
        executable="parameter_bridge",
        name=arguments.get("bridge_name") or "ros_gz_bridge",
        parameters=({"config_file": config},) if config else (),
    )


_SPAWN_OPTIONS = {
    "world": "-world",
    "file": "-file",
    "model_string": "-string",
    "topic": "-topic",
    "entity_name": "-name",
    "allow_renaming": "-allow_renaming",
    "x": "-x",
    "y": "-y",
    "z": "-z",
    "roll": "-R",
    "pitch": "-P",
    "yaw": "-Y",
}


def _spawn_model(arguments: Mapping[str, str], context: LaunchContext, process: LaunchedProcess) -> None:
    given = {option: arguments[name] for name, option in _SPAWN_OPTIONS.items() if arguments.get(name)}
    renaming = given.pop("-allow_renaming", "")  # a flag of gflags' takes no word after it
    words = [word for pair in given.items() for word in pair]
    words += [f"-allow_renaming={renaming.lower()}"] if renaming else []
    _start_node(context, process, package="ros_gz_sim", executable="create", arguments=tuple(words), ends=True)


def _classic(arguments: Mapping[str, str], context: LaunchContext, process: LaunchedProcess) -> None:
    world = WorldStart(
        "classic",
        arguments.get("world") or None,
        paused=_says_true(arguments.get("pause", "")),
        verbosity=4 if _says_true(arguments.get("verbose", "")) else 1,
        server_only=not _says_true(arguments.get("gui", "true")),
        arguments=dict(arguments),
    )
    if _says_true(arguments.get("server", "true")):
        _start_world(context, process, world)


def _nothing(arguments: Mapping[str, str], context: LaunchContext, process: LaunchedProcess) -> None:
    """A window, or a program that the twin has its own of."""


def _says_true(text: str) -> bool:
    return text.strip().lower() in _TRUE


def _start_world(context: LaunchContext, process: LaunchedProcess, world: WorldStart) -> None:
    from dataclasses import replace

    context.start(replace(process, kind=WORLD, world=world))


def _start_node(context: LaunchContext, process: LaunchedProcess, **values: object) -> None:
    from dataclasses import replace

    base = context.launch_configurations.get("ros_namespace") or "/"
    context.start(replace(process, kind=NODE, namespace=base, **values))  # type: ignore[arg-type]


_GZ_SIM = StandIn(
    {
        "gz_args": "",
        "gz_version": "8",
        "ign_args": "",
        "ign_version": "",
        "debugger": "false",
        "debug_env": "false",
        "on_exit_shutdown": "false",
    },
    _gz_sim,
)
_SPAWN = dict.fromkeys(_SPAWN_OPTIONS, "") | {"allow_renaming": "False"}
_BRIDGE = {
    "bridge_name": "",
    "config_file": "",
    "namespace": "",
    "container_name": "ros_gz_container",
    "create_own_container": "False",
    "use_composition": "False",
    "use_respawn": "False",
    "log_level": "info",
    "bridge_params": "",
}
_SERVER = {
    "world_sdf_file": "",
    "world_sdf_string": "",
    "container_name": "ros_gz_container",
    "create_own_container": "False",
    "use_composition": "False",
}
_GZSERVER = {
    "world": "",
    "version": "false",
    "verbose": "false",
    "lockstep": "false",
    "help": "false",
    "pause": "false",
    "physics": "",
    "play": "",
    "record": "false",
    "record_encoding": "",
    "record_path": "",
    "record_period": "",
    "record_filter": "",
    "seed": "",
    "iters": "",
    "minimal_comms": "false",
    "profile": "",
    "extra_gazebo_args": "",
    "params_file": "",
    "gdb": "false",
    "valgrind": "false",
    "init": "true",
    "factory": "true",
    "force_system": "true",
    "server_required": "false",
}
_GZCLIENT = {
    "version": "false",
    "verbose": "false",
    "help": "false",
    "extra_gazebo_args": "",
    "gdb": "false",
    "valgrind": "false",
    "gui_required": "false",
}
_GAZEBO = _GZSERVER | _GZCLIENT | {"gui": "true", "server": "true", "gui_required": "false"}

_STAND_INS: Mapping[str, Mapping[str, StandIn]] = {
    "ros_gz_sim": {
        "gz_sim.launch.py": _GZ_SIM,
        "gz_server.launch.py": StandIn(_SERVER, _gz_server),
        "gz_server.launch": StandIn(_SERVER, _gz_server),
        "gz_spawn_model.launch.py": StandIn(_SPAWN, _spawn_model),
        "gz_spawn_model.launch": StandIn(_SPAWN, _spawn_model),
        "ros_gz_sim.launch.py": StandIn(_BRIDGE | _SERVER, _ros_gz_sim),
        "ros_gz_sim.launch": StandIn(_BRIDGE | _SERVER, _ros_gz_sim),
        "ros_gz_spawn_model.launch.py": StandIn(_BRIDGE | _SPAWN, _ros_gz_spawn_model),
        "ros_gz_spawn_model.launch": StandIn(_BRIDGE | _SPAWN, _ros_gz_spawn_model),
    },
    "ros_gz_bridge": {
        "ros_gz_bridge.launch.py": StandIn(_BRIDGE, _start_bridge),
        "ros_gz_bridge.launch": StandIn(_BRIDGE, _start_bridge),
    },
    "ros_ign_gazebo": {"ign_gazebo.launch.py": _GZ_SIM, "gz_sim.launch.py": _GZ_SIM},
    "gazebo_ros": {
        "gazebo.launch.py": StandIn(_GAZEBO, _classic),
        "gzserver.launch.py": StandIn(_GZSERVER, _classic),
        "gzclient.launch.py": StandIn(_GZCLIENT, _nothing),
    },
}
BUILT_IN_PACKAGES = frozenset(_STAND_INS)


def include_stand_in(path: str, context: LaunchContext, place: Place | None) -> None:
    """Includes a launch file of a built-in package: its arguments are the configurations at hand.

    Args:
        path: below `drake_twin.ros2.packages.BUILT_IN`.
        context: gives the configurations.
        place: where it is included.

    Raises:
        InputError: the package has no such launch file.
    """
    package, stand_in = _find(path, place)
    for name, default in stand_in.arguments.items():
        context.declared.add(name)
        if default:
            context.launch_configurations.setdefault(name, default)
    arguments = {
        name: str(context.launch_configurations[name])
        for name in stand_in.arguments
        if name in context.launch_configurations
    }
    process = LaunchedProcess(
        kind=WORLD, executable=PurePosixPath(path).name, package=package, place=place or Place(path)
    )
    stand_in.start(arguments, context, process)


def stand_in_arguments(path: str) -> list[LaunchArgument]:
    """The arguments of a launch file of a built-in package."""
    _, stand_in = _find(path, None)
    return [LaunchArgument(name, default) for name, default in stand_in.arguments.items()]


def _find(path: str, place: Place | None) -> tuple[str, StandIn]:
    package = Path(path).relative_to(BUILT_IN).parts[0]
    files = _STAND_INS[package]
    name = PurePosixPath(path).name
    if name not in files:
        raise InputError(
            f"package {package!r} is built in, and has no launch file {name!r}",
            file=None if place is None else place.file,
            line=None if place is None else place.line,
            value=name,
            valid=files,
        )
    return package, files[name]
