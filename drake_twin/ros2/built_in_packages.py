"""Packages that are built in: the launch files of Gazebo's packages, as what including them starts."""

import shlex
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path, PurePosixPath

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.ros2.launched import NODE, WORLD, LaunchArgument, LaunchedProcess, WorldStart
from drake_twin.ros2.packages import BUILT_IN

_TRUE = ("true", "1")
_Start = Callable[[Mapping[str, str], LaunchedProcess], list[LaunchedProcess]]


@dataclass(frozen=True)
class BuiltInFile:
    """A launch file of a built-in package.

    Attributes:
        arguments: Its arguments and their defaults; "" where ROS's file computes one.
        start: What including it starts, given its arguments and a process with the package, place and namespace.
    """

    arguments: Mapping[str, str]
    start: _Start


def world_of_gz_args(gz_args: str, arguments: Mapping[str, str] | None = None) -> WorldStart:
    """Return the world that gz's command line asks for.

    Args:
        gz_args: The command line's arguments, such as ``-r -v 4 empty.sdf``.
        arguments: The launch file's arguments, to keep.

    Raises:
        InputError: If the text cannot be split into words.
    """
    try:
        words = shlex.split(gz_args)
    except ValueError as error:
        raise InputError(f"gz_args is {gz_args!r}, which cannot be split into words ({error})") from None
    world, running, server, window = None, False, False, False
    position = 0
    while position < len(words):
        word = words[position]
        name, equals, _ = word.partition("=")
        position += 1
        if name in ("-v", "--verbose"):  # a number may follow
            follows = words[position] if position < len(words) and not equals else ""
            position += 1 if follows.isdigit() else 0
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


def _gz_sim(arguments: Mapping[str, str], base: LaunchedProcess) -> list[LaunchedProcess]:
    text = f"{arguments.get('gz_args') or arguments.get('ign_args', '')}"
    return [_world(base, world_of_gz_args(text, arguments))]


def _gz_server(arguments: Mapping[str, str], base: LaunchedProcess) -> list[LaunchedProcess]:
    world = arguments.get("world_sdf_file") or arguments.get("world_sdf_string") or None
    return [_world(base, WorldStart("gz", world, arguments=dict(arguments)))]


def _ros_gz_sim(arguments: Mapping[str, str], base: LaunchedProcess) -> list[LaunchedProcess]:
    return _gz_server(arguments, base) + _bridge(arguments, base)


def _ros_gz_spawn_model(arguments: Mapping[str, str], base: LaunchedProcess) -> list[LaunchedProcess]:
    return _bridge(arguments, base) + _spawn_model(arguments, base)


def _bridge(arguments: Mapping[str, str], base: LaunchedProcess) -> list[LaunchedProcess]:
    config = arguments.get("config_file", "")
    return [
        replace(
            base,
            kind=NODE,
            package="ros_gz_bridge",
            executable="parameter_bridge",
            name=arguments.get("bridge_name") or "ros_gz_bridge",
            parameters=({"config_file": config},) if config else (),
        )
    ]


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


def _spawn_model(arguments: Mapping[str, str], base: LaunchedProcess) -> list[LaunchedProcess]:
    given = {option: arguments[name] for name, option in _SPAWN_OPTIONS.items() if arguments.get(name)}
    renaming = given.pop("-allow_renaming", "")  # gflags takes a flag's value only after an equals sign
    words = [word for pair in given.items() for word in pair]
    words += [f"-allow_renaming={renaming.lower()}"] if renaming else []
    return [
        replace(base, kind=NODE, package="ros_gz_sim", executable="create", arguments=tuple(words), ends=True),
    ]


def _classic(arguments: Mapping[str, str], base: LaunchedProcess) -> list[LaunchedProcess]:
    world = WorldStart(
        "classic",
        arguments.get("world") or None,
        paused=_says_true(arguments.get("pause", "")),
        arguments=dict(arguments),
    )
    return [_world(base, world)] if _says_true(arguments.get("server", "true")) else []


def _nothing(arguments: Mapping[str, str], base: LaunchedProcess) -> list[LaunchedProcess]:
    """Start nothing: the file opens a window."""
    return []


def _world(base: LaunchedProcess, world: WorldStart) -> LaunchedProcess:
    return replace(base, kind=WORLD, world=world, namespace="/")


def _says_true(text: str) -> bool:
    return text.strip().lower() in _TRUE


_GZ_SIM = BuiltInFile(
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

_FILES: Mapping[str, Mapping[str, BuiltInFile]] = {
    "ros_gz_sim": {
        "gz_sim.launch.py": _GZ_SIM,
        "gz_server.launch.py": BuiltInFile(_SERVER, _gz_server),
        "gz_server.launch": BuiltInFile(_SERVER, _gz_server),
        "gz_spawn_model.launch.py": BuiltInFile(_SPAWN, _spawn_model),
        "gz_spawn_model.launch": BuiltInFile(_SPAWN, _spawn_model),
        "ros_gz_sim.launch.py": BuiltInFile(_BRIDGE | _SERVER, _ros_gz_sim),
        "ros_gz_sim.launch": BuiltInFile(_BRIDGE | _SERVER, _ros_gz_sim),
        "ros_gz_spawn_model.launch.py": BuiltInFile(_BRIDGE | _SPAWN, _ros_gz_spawn_model),
        "ros_gz_spawn_model.launch": BuiltInFile(_BRIDGE | _SPAWN, _ros_gz_spawn_model),
    },
    "ros_gz_bridge": {
        "ros_gz_bridge.launch.py": BuiltInFile(_BRIDGE, _bridge),
        "ros_gz_bridge.launch": BuiltInFile(_BRIDGE, _bridge),
    },
    "ros_ign_gazebo": {"ign_gazebo.launch.py": _GZ_SIM, "gz_sim.launch.py": _GZ_SIM},
    "gazebo_ros": {
        "gazebo.launch.py": BuiltInFile(_GAZEBO, _classic),
        "gzserver.launch.py": BuiltInFile(_GZSERVER, _classic),
        "gzclient.launch.py": BuiltInFile(_GZCLIENT, _nothing),
    },
}
BUILT_IN_PACKAGES = frozenset(_FILES)


def built_in_arguments(path: str, place: Place | None = None) -> list[LaunchArgument]:
    """Return the arguments of a launch file of a built-in package.

    Args:
        path: The file, below `drake_twin.ros2.packages.BUILT_IN`.
        place: Where it is included.

    Raises:
        InputError: If the package has no such launch file.
    """
    _, file = _find(path, place)
    return [LaunchArgument(name, default) for name, default in file.arguments.items()]


def built_in_processes(
    path: str, arguments: Mapping[str, str], namespace: str, place: Place | None
) -> list[LaunchedProcess]:
    """Return what including a launch file of a built-in package starts.

    Args:
        path: The file, below `drake_twin.ros2.packages.BUILT_IN`.
        arguments: Values by name; those that are not the file's are ignored.
        namespace: The nodes' namespace.
        place: Where it is included.

    Raises:
        InputError: If the package has no such launch file.
    """
    package, file = _find(path, place)
    own = {name: arguments[name] for name in file.arguments if name in arguments}
    name = PurePosixPath(path).name
    base = LaunchedProcess(WORLD, name, place or Place(path), package=package, namespace=namespace)
    return file.start(own, base)


def _find(path: str, place: Place | None) -> tuple[str, BuiltInFile]:
    package = Path(path).relative_to(BUILT_IN).parts[0]
    files = _FILES[package]
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
