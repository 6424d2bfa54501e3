"""The users' own Python nodes that a launch file starts."""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from drake_twin.description.built_in_programs import built_in_programs
from drake_twin.description.package_index import MissingPackageError, PackageIndex
from drake_twin.description.python_programs import is_python, python_programs
from drake_twin.description.source_file import file_bytes, file_text
from drake_twin.findings import Finding, Kind
from drake_twin.from_launch.launched_robots import LaunchedRobot, parameter_file
from drake_twin.ros2.launched import (
    COMPONENT,
    NODE,
    PROCESS,
    Ending,
    LaunchedProcess,
    ParameterText,
    UnfiredHandler,
    absolute_name,
)
from drake_twin.ros2.ros_arguments import OWN_NODE, ros_arguments
from drake_twin.scenario import NodeProgram
from drake_twin.scenario.node_program import OnExit, Respawn

# The type of the service, in gazebo_msgs, ros_gz_interfaces and simulation_interfaces.
_SPAWN_SERVICE = b"SpawnEntity"

_NOT_DONE = {
    "cwd": "a node starts in the working folder of the run",
    "prefix": "a node runs in the twin's process, where no other command can start it",
}


def launched_node(process: LaunchedProcess, packages: PackageIndex, findings: list[Finding]) -> NodeProgram | None:
    """Return the program of a process; None if it is not a Python program of a package that is there.

    Args:
        process: The process.
        packages: Where packages are searched.
        findings: Gets what the launch file asks for the program and the twin does not do.
    """
    node = _script(process) if process.kind == PROCESS else _node(process, packages)
    if node is not None:
        for keyword in process.not_done:
            text = f"{keyword} of {process.what}: {_NOT_DONE[keyword]}"
            findings.append(Finding.at(Kind.IGNORED, text, process.place))
    return node


def _node(process: LaunchedProcess, packages: PackageIndex) -> NodeProgram | None:
    if process.kind not in (NODE, COMPONENT) or process.package is None:
        return None
    known = built_in_programs(process.package)
    if process.kind == NODE:
        with suppress(MissingPackageError):
            known |= python_programs(packages.find(process.package, process.place.file))
    if process.executable not in known:
        return None
    namespace = "" if process.namespace == "/" else process.namespace
    own = f"{OWN_NODE}:" if process.name else ""  # launch_ros writes a named node's under its name, others' for all
    parameters = [
        Path(parameter_file(item))
        if isinstance(item, Path | ParameterText)
        else {f"{own}{name}": value for name, value in item.items()}
        for item in process.parameters
    ]
    return NodeProgram(
        executable=process.executable,
        package=process.package,
        arguments=(*process.arguments, *ros_arguments(process.name or "", namespace, process.remappings, parameters)),
        environment={name: value for name, value in process.environment.items() if value is not None},
        time=process.start_time,
        respawn=_respawn(process),
    )


def _respawn(process: LaunchedProcess) -> Respawn | None:
    return None if process.respawn is None else Respawn(*process.respawn)


def followers(
    key: int,
    endings: Iterable[Ending],
    packages: PackageIndex,
    findings: list[Finding],
    happens: set[UnfiredHandler],
) -> tuple[OnExit, ...]:
    """Return what follows when a node program has ended.

    Args:
        key: Its process.
        endings: What follows when processes end.
        packages: Where packages are searched.
        findings: Gets what would start then and is not a node program.
        happens: Gets the event handlers whose event comes.
    """
    return tuple(_follower(ending, packages, findings, happens) for ending in endings if ending.key == key)


def _follower(ending: Ending, packages: PackageIndex, findings: list[Finding], happens: set[UnfiredHandler]) -> OnExit:
    nodes = []
    happens.update(ending.handlers)
    for process in ending.processes:
        node = launched_node(process, packages, findings)
        if node is not None:
            nodes.append(replace(node, on_exit=followers(process.key, ending.endings, packages, findings, happens)))
            continue
        common = " (it waits for the end of a node, and then only Python nodes can start)"
        findings.append(Finding.at(Kind.NOT_STARTED, process.what + common, process.place, common=common))
    return OnExit(ending.code, tuple(nodes), ending.log, ending.shutdown)


def spawns(node: NodeProgram, packages: PackageIndex, file: Path) -> bool:
    """Return whether a node program asks a simulator for a robot: its source names the service's type.

    Args:
        node: The program.
        packages: Where packages are searched.
        file: The launch file.
    """
    source = Path(node.executable)
    if node.package:
        with suppress(MissingPackageError):
            program = python_programs(packages.find(node.package, str(file))).get(node.executable)
            source = source if program is None else program.file
    try:
        return _SPAWN_SERVICE in file_bytes(source)
    except OSError:
        return False


def publishes_simulated_states(process: LaunchedProcess, robots: Iterable[LaunchedRobot]) -> bool:
    """Return whether a ``joint_state_publisher`` has the topic on which a robot's joint states come from the twin."""
    if process.package != process.executable or process.package != "joint_state_publisher":
        return False
    return process.resolve("joint_states") in {absolute_name("joint_states", robot.namespace) for robot in robots}


def needs_terminal(process: LaunchedProcess) -> bool:
    """Return whether a node reads keys from a terminal of its own, which a launch file's node does not have."""
    return process.executable in ("teleop_twist_keyboard", "turtle_teleop_key")


def _script(process: LaunchedProcess) -> NodeProgram | None:
    """Return the program of ``python3 SCRIPT …`` or of a script that is started itself, if it uses rclpy."""
    words = [process.executable, *process.arguments]
    if Path(words[0]).name.startswith("python"):
        words = words[1:]
    file = Path(words[0]) if words else Path()
    if not file.is_absolute() or not is_python(file) or "rclpy" not in file_text(file, errors="replace"):
        return None
    return NodeProgram(str(file), arguments=tuple(words[1:]), time=process.start_time, respawn=_respawn(process))
