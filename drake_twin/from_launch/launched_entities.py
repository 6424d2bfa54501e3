"""What an evaluated launch file starts, as robots, frames, commands and a world: plain data and hints.

Nothing is planned here. Values that depend on a robot's files beyond its description (its controllers, its height above
the ground) are hints that `drake_twin.builder.launch_file` turns into a scenario.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path

from drake_twin.dataclass import dataclass
from drake_twin.description.package_index import PackageIndex, containing_package, workspace_of
from drake_twin.description.source_file import file_text
from drake_twin.description.world_file import WorldModel
from drake_twin.errors import InputError
from drake_twin.findings import Cause, Finding, Kind, Place, Weight
from drake_twin.from_launch.bridges import BridgeLine, bridge_lines, is_bridge, renamed, stamped
from drake_twin.from_launch.controller_managers import requests_by_robot
from drake_twin.from_launch.launched_controllers import (
    ACTIVE,
    INACTIVE,
    UNCONFIGURED,
    ControllerRequest,
    as_nodes,
    check_parameter_files,
    controller_requests,
    published_commands,
)
from drake_twin.from_launch.launched_nodes import (
    followers,
    launched_node,
    needs_terminal,
    publishes_simulated_states,
    spawns,
)
from drake_twin.from_launch.launched_robots import (
    LaunchedRobot,
    LaunchedRobots,
    command_line_file,
    is_spawner,
    is_state_publisher,
    parameter_file,
)
from drake_twin.from_launch.launched_world import LaunchedWorld, launched_world, world_start
from drake_twin.from_launch.not_started import calls_spawn, is_window, misspelt_package, never_happened, why_not_started
from drake_twin.from_launch.published_frames import frame_prefix, publish_frequency
from drake_twin.from_launch.static_frames import static_frame
from drake_twin.from_launch.written_files import WrittenFiles
from drake_twin.ros2.launched import (
    Launched,
    LaunchedProcess,
    ParameterText,
    UnfiredHandler,
    WorldStart,
    absolute_name,
)
from drake_twin.scenario import Command, NodeProgram, Robot, StaticTransform, World, name_in_twin

_FOLDER_VARIABLES = ("GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "GAZEBO_RESOURCE_PATH")

# The nodes whose work the twin does itself.
_BUILT_IN = {("controller_manager", "ros2_control_node")}


@dataclass(frozen=True)
class RobotHint:
    """A robot that is started, as far as its launch file defines it.

    Attributes:
        robot: The scenario's entry. Its controllers may be missing, its remappings may have topics of other robots.
        on_ground: Whether it is spawned without a pose, to stand on the ground.
        requests: Controller → the process that asks for it.
        place: Where it is started.
    """

    robot: Robot
    on_ground: bool
    requests: Mapping[str, LaunchedProcess]
    place: Place


@dataclass(frozen=True)
class LaunchedFrame:
    """A static transform and the process that publishes it."""

    transform: StaticTransform
    process: LaunchedProcess


@dataclass(frozen=True)
class LaunchedEntities:
    """What a launch file starts.

    Attributes:
        robots: The robots, at least one unless a node spawns one.
        frames: The static transforms; some may place a frame that a robot also places.
        commands: The published messages; some topics may have no subscriber.
        world: The world.
        sensing: The models of the world that have sensors, without the robots.
        time_step: The physics step of the world's file (s).
        packages: Resolves the packages in its files.
        folders: The folders of these packages.
        paused: Whether the simulator starts paused, like gz without ``-r``.
        end: The simulation time (s) at which a timer of the launch file ends it; None without one.
        only_displayed: Whether no robot is spawned or controlled, so that no physics is needed.
        bridges: The topics that bridges carry; None where no bridge is started.
        nodes: The users' own Python nodes.
        findings: The findings of what the twin does not do.
        log: The output of the launch file, and the assumptions made.
    """

    robots: tuple[RobotHint, ...]
    frames: tuple[LaunchedFrame, ...]
    commands: tuple[Command, ...]
    world: World
    time_step: float | None
    packages: PackageIndex
    folders: tuple[str, ...]
    paused: bool
    only_displayed: bool
    bridges: tuple[BridgeLine, ...] | None = None
    sensing: tuple[WorldModel, ...] = ()
    nodes: tuple[NodeProgram, ...] = ()
    end: float | None = None
    findings: tuple[Finding, ...] = ()
    log: tuple[str, ...] = field(default=())


def launched_entities(launched: Launched, file: Path, packages: PackageIndex) -> LaunchedEntities:
    """Sort what a launch file starts.

    Args:
        launched: The result of its evaluation.
        file: The launch file.
        packages: The folders of packages to search first.

    Raises:
        InputError: If it starts no robot; the text names everything that is missing.
    """
    return _Sorter(launched, file, packages).entities()


class _Sorter:
    def __init__(self, launched: Launched, file: Path, packages: PackageIndex):
        self._launched = launched
        self._file = file
        self._processes = [command for process in launched.processes for command in as_nodes(process)]
        folders = [*map(str, packages.folders), *_folders_of(file, self._processes)]
        self._folders = tuple(dict.fromkeys(folders))
        self._packages = PackageIndex(self._folders)
        self._log = list(launched.log)
        self._findings: list[Finding] = []
        self._requests: list[ControllerRequest] = []
        self._commands: list[Command] = []
        self._frames: list[LaunchedFrame] = []
        self._nodes: list[NodeProgram] = []
        self._happens: set[UnfiredHandler] = set()  # when a node has ended
        self._bridges: tuple[BridgeLine, ...] | None = None
        self._written = WrittenFiles(self._processes)
        self._worlds: list[tuple[WorldStart, LaunchedProcess]] = []

    def entities(self) -> LaunchedEntities:
        found = LaunchedRobots(self._processes, self._packages)
        for process in self._processes:
            self._sort(process, found)
        world = launched_world(self._worlds, self._file, self._packages, self._findings)
        found.add_those_of_world(world)
        if found.only_displayed:
            world = LaunchedWorld(World(gravity=(0.0, 0.0, 0.0), ground=False))
        self._findings += found.findings
        self._log += found.warnings
        self._findings += never_happened(self._launched, self._file, self._happens)
        if not (found.robots or self._needs_no_robot(found)):
            raise self._no_robot()
        robots = tuple(self._robots(found))
        return LaunchedEntities(
            robots=robots,
            frames=tuple(self._frames),
            commands=tuple(self._commands),
            world=replace(world.world, bridged=self._bridged()) if world.sensing else world.world,
            sensing=world.sensing,
            time_step=world.time_step,
            packages=self._packages,
            folders=self._folders,
            paused=bool(self._worlds) and self._worlds[-1][0].paused,
            only_displayed=found.only_displayed,
            bridges=self._bridges,
            nodes=tuple(self._nodes),
            end=self._launched.shutdown_time or None,
            findings=tuple(self._findings),
            log=tuple(self._log),
        )

    def _bridged(self) -> dict[str, str] | None:
        """Return Gazebo topic → ROS topic of what bridges carry to ROS; None where no bridge is started."""
        return None if self._bridges is None else {line.gz: line.ros for line in self._bridges if line.is_to_ros}

    def _sort(self, process: LaunchedProcess, found: LaunchedRobots) -> None:
        if (package := misspelt_package(process)) is not None:
            what = f"{process.what}: unknown package {process.package!r}. Did you mean {package!r}?"
            self._drop(what, process, Kind.REFUSED_BY_ROS)
        try:
            if is_bridge(process):
                self._bridges = (*(self._bridges or ()), *bridge_lines(process, self._findings, self._written.texts))
                return
            requests = controller_requests(process)
            commands = published_commands(process)
            if requests is not None:
                self._requests += requests
            elif commands is not None:
                self._commands += commands
            elif process.executable == "static_transform_publisher":
                self._frames.append(LaunchedFrame(static_frame(process), process))
            elif (start := world_start(process)) is not None:
                self._worlds += [] if start.window_only else [(start, process)]
            elif not (
                is_spawner(process)
                or is_state_publisher(process)
                or self._written.are_by(process)
                or (process.package, process.executable) in _BUILT_IN
                or (found.only_displayed and process.executable.startswith("joint_state_publisher"))
            ):
                is_needed = not (publishes_simulated_states(process, found.robots) or needs_terminal(process))
                if is_needed and (node := launched_node(process, self._packages, self._findings)) is not None:
                    more = (self._packages, self._findings, self._happens)
                    following = followers(process.key, self._launched.endings, *more)
                    self._nodes.append(replace(node, on_exit=following))
                    return
                self._drop(why_not_started(process), process, Kind.WINDOW if is_window(process) else Kind.NOT_STARTED)
        except InputError as error:
            self._drop(f"{process.what}: {str(error).rstrip('.')}", process)

    def _drop(self, what: str, process: LaunchedProcess, kind: Kind = Kind.NOT_STARTED) -> None:
        """Add a finding for something that is not started, with its place in the launch file."""
        if kind is Kind.WINDOW:
            finding = Finding.at(kind, what, process.place, weight=Weight.LOOKS, cause=Cause.WINDOW)
        else:
            weight = Weight.LOST if calls_spawn(process) else Weight.MOVES
            finding = Finding.at(kind, what, process.place, weight=weight, common=what.removeprefix(process.what))
        self._findings.append(finding)

    def _robots(self, found: LaunchedRobots) -> Iterator[RobotHint]:
        managers = requests_by_robot(found.robots, self._requests, self._findings, self._log, found.absent_managers)
        is_gazebo_sim = bool(self._worlds) and self._worlds[-1][0].simulator == "gz"
        namespaces: set[str] = set()
        links: set[str] = set()
        late: dict[float, list[str]] = {}
        for launched in found.robots:
            name = name_in_twin(launched.name)
            requests = managers.get(launched.name, [])
            namespace = launched.namespace
            if namespace in namespaces and launched.controller_manager is not None:
                namespace = f"{namespace.rstrip('/')}/{name}"
                what = f"another robot's controller manager has its namespace, so its topics are below {namespace}"
                self._findings.append(Finding(Kind.WARNING, what, robot=name))
            if launched.controller_manager is not None:
                namespaces.add(namespace)
            prefix = frame_prefix(launched.publisher)
            if any(prefix + link in links for link in launched.links if prefix + link != "world"):
                prefix = f"{name}/"
                what = "another robot publishes frames of the same names, so its own begin with its name and / on /tf"
                self._findings.append(Finding(Kind.WARNING, what, robot=name))
            links |= {prefix + link for link in launched.links}
            if launched.process.start_time > 0:
                late.setdefault(launched.process.start_time, []).append(name)
            if is_gazebo_sim and launched.has_colliding_links and not launched.self_collides:
                what = (
                    "its links' <self_collide> has no effect, as in Gazebo Sim, which reads only that of an SDF model"
                )
                finding = Finding(Kind.WARNING, what, name, launched.model, weight=Weight.LOOKS, cause=Cause.CONTACT)
                self._findings.append(finding)
            pose = launched.pose
            robot = Robot(
                name=name,
                model=launched.model,
                xyz=(0.0, 0.0, 0.0) if pose is None else pose.xyz,
                rpy=(0.0, 0.0, 0.0) if pose is None else pose.rpy,
                namespace=namespace,
                frame_prefix=prefix,
                publish_frequency=publish_frequency(launched.publisher),
                controllers=self._parameter_files(launched, requests),
                active_controllers=tuple(item.name for item in requests if item.state == ACTIVE),
                inactive_controllers=tuple(item.name for item in requests if item.state == INACTIVE),
                unconfigured_controllers=tuple(item.name for item in requests if item.state == UNCONFIGURED),
                remappings=self._remappings(launched, requests, namespace),
                stamped_topics=stamped(self._bridges or ()),
                bridged=self._bridged(),
                self_collision=launched.self_collides if is_gazebo_sim else None,
            )
            processes = {request.name: request.process for request in requests}
            yield RobotHint(robot, pose is None, processes, launched.process.place)
        for time, names in late.items():
            are = "it is" if len(names) == 1 else "they are"
            self._log.append(f"{', '.join(names)}: {are} spawned after {time:g} s in ROS, but at the start here")

    def _parameter_files(self, launched: LaunchedRobot, requests: Sequence[ControllerRequest]) -> tuple[str, ...]:
        given = []
        for request in requests:
            error = check_parameter_files(request)
            if error is None:
                given += [self._filled_in(Path(file), request.name) for file in request.parameter_files]
                given += command_line_file(request)
            else:
                self._drop(f"controller {request.name}: {error}", request.process)
        if not given:
            return launched.parameter_files
        own = launched.parameter_files or [self._as_started(file, launched.model) for file in launched.plugin_files]
        return tuple(dict.fromkeys((*own, *given)))

    def _as_started(self, file: str, model: str) -> str:
        """Return the absolute path of a file that a robot's file names; unchanged if it does not exist."""
        try:
            return str(self._packages.resolve_as_started(file, model))
        except InputError:
            return file

    def _filled_in(self, file: Path, controller: str) -> str:
        """Return a spawner's parameters file with its ``$(var name)`` substituted by launch configurations.

        A file for any node (``/**``) and no other becomes one for the controller: only it reads the file.
        """
        text = file_text(file, errors="replace")
        known = self._launched.configurations
        filled = re.sub(r"\$\(var\s+([\w.]+)\s*\)", lambda match: known.get(match[1], match[0]), text)
        if re.findall(r"^[^\s#-].*?:", filled, re.MULTILINE) in (["/**:"], ["'/**':"], ['"/**":']):
            filled = re.sub(
                r"""^(['"]?)/\*\*\1:(?=\s*(#.*)?\n\s+ros__parameters)""", f"{controller}:", filled, flags=re.MULTILINE
            )
        return str(file) if filled == text else parameter_file(ParameterText(file, filled))

    def _remappings(
        self, launched: LaunchedRobot, requests: Sequence[ControllerRequest], namespace: str
    ) -> dict[str, str]:
        """Return the topics that the launch file renames.

        They are those of controllers, by their spawners or the ros2_control_node, of the description, and Gazebo's own
        through a bridge.
        """
        found = {}
        own = namespace.rstrip("/")
        for request in requests:
            node = f"{own}/{request.name}"
            for source, target in request.remappings:
                found[absolute_name(source, namespace, node)] = absolute_name(target, namespace, node)
        if launched.process.executable == "ros2_control_node":  # controllers are nodes of its process
            for source, target in launched.process.remappings:
                if not source.startswith("~"):
                    found[absolute_name(source, namespace)] = absolute_name(target, namespace)
        if launched.publisher is not None:
            topic = launched.publisher.resolve("robot_description")
            if topic != f"{own}/robot_description":
                found[f"{own}/robot_description"] = topic
        return found | renamed(self._bridges or ())

    def _needs_no_robot(self, found: LaunchedRobots) -> bool:
        """Return whether there are node programs that spawn robots, or nothing but node programs."""
        if any(spawns(node, self._packages, self._file) for node in self._nodes):
            return True
        asks = self._worlds or self._requests or found.findings or self._launched.failed_includes
        of_robots = (is_spawner(process) or is_state_publisher(process) for process in self._processes)
        return bool(self._nodes) and not (asks or any(of_robots))

    def _no_robot(self) -> InputError:
        text = "the launch file starts no robot"
        if self._requests:
            names = ", ".join(dict.fromkeys(request.name for request in self._requests))
            text += f" for its controllers ({names}): include it in a launch file that starts a robot"
        if self._launched.shutdown is not None:
            text += f": it shuts itself down ({self._launched.shutdown})"
        reasons = dict.fromkeys(item.what for item in self._findings if item.kind is Kind.NOT_STARTED)
        if reasons:
            text += f". Not started: {'; '.join(reasons)}"
        if self._launched.absent_packages:
            text += (
                f". Absent packages: {', '.join(self._launched.absent_packages)}: give the folders that contain them by"
                " --package-path"
            )
        return InputError(text, file=self._file)


def _folders_of(file: Path, processes: Iterable[LaunchedProcess]) -> Iterable[str]:
    """Yield the folders of the launch files' own packages, and those of Gazebo's search paths."""
    files = dict.fromkeys([str(file), *(process.place.file for process in processes)])
    for name in files:
        package = containing_package(name)
        if package is not None:
            yield str(workspace_of(package))
            repository = next((folder for folder in package.parents if (folder / ".git").exists()), None)
            if repository is not None:
                yield str(repository)
    for process in processes:
        for variable in _FOLDER_VARIABLES:
            for folder in (process.environment.get(variable) or "").split(os.pathsep):
                if folder and Path(folder).is_dir():
                    yield os.path.abspath(folder)
