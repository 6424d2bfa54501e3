"""The scenario of a ROS 2 launch file."""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_twin.description.package_index import PackageIndex, containing_package, workspace_of
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind, Place, merged
from drake_twin.from_launch.launched_controllers import (
    ControllerRequest,
    as_nodes,
    check_parameter_files,
    controller_requests,
    published_commands,
    words_of,
)
from drake_twin.from_launch.launched_robots import (
    LaunchedRobot,
    LaunchedRobots,
    is_spawner,
    is_state_publisher,
    parameter_file,
    parameters,
)
from drake_twin.from_launch.not_started import is_window, why_not_started
from drake_twin.from_launch.static_frames import static_frame
from drake_twin.ros2.launched import WORLD, Launched, LaunchedProcess, ParameterText, WorldStart, absolute_name
from drake_twin.scenario import (
    LONGEST_STEP,
    SHORTEST_STEP,
    Command,
    Robot,
    Scenario,
    ScenarioError,
    StaticTransform,
    World,
)

if TYPE_CHECKING:
    from drake_twin.planning.robot_plan import RobotPlan
    from drake_twin.ros2.launch.launch_description import LaunchDescription

_FOLDER_VARIABLES = ("GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH", "GAZEBO_RESOURCE_PATH")

# What the twin does itself.
_BUILT_IN = {
    ("ros_gz_bridge", "parameter_bridge"),
    ("ros_ign_bridge", "parameter_bridge"),
    ("controller_manager", "ros2_control_node"),
}


@dataclass(frozen=True)
class LaunchedTwin:
    """A launch file as a scenario.

    Attributes:
        scenario: the scenario; its findings name what the launch file asks for and the twin does not do.
        paused: whether the simulator is started paused, as gz without ``-r``.
        only_displayed: whether no robot is spawned or controlled, so that there is no physics.
        log: what the launch file prints, and what was assumed.
    """

    scenario: Scenario
    paused: bool
    only_displayed: bool
    log: tuple[str, ...]


def launch_file_scenario(
    file: str | Path,
    arguments: Mapping[str, str] | None = None,
    package_paths: Sequence[str] = (),
    *,
    time_step: float | None = None,
) -> LaunchedTwin:
    """Evaluates a launch file.

    Args:
        file: a Python, XML or YAML launch file.
        arguments: values for its arguments.
        package_paths: folders of ROS packages to look in first.
        time_step: the physics step (s); by default the world's, or 0.001.

    Raises:
        InputError: the file cannot be used, or starts no robot; the text names all that is missing.
    """
    from drake_twin.ros2.evaluate import evaluate

    packages = PackageIndex(package_paths)
    return _scenario(evaluate(file, arguments, packages), Path(file), packages, time_step)


def launch_description_scenario(
    description: LaunchDescription,
    arguments: Mapping[str, str] | None = None,
    package_paths: Sequence[str] = (),
    *,
    time_step: float | None = None,
) -> LaunchedTwin:
    """The same for a launch description made in Python; see `launch_file_scenario`."""
    from drake_twin.ros2.evaluate import evaluate_description

    packages = PackageIndex(package_paths)
    file = Path("launch description" if description.place is None else description.place.file)
    return _scenario(evaluate_description(description, arguments, packages), file, packages, time_step)


def _scenario(launched: Launched, file: Path, packages: PackageIndex, time_step: float | None) -> LaunchedTwin:
    return _LaunchedScenario(launched, file, packages).build(time_step)


class _LaunchedScenario:
    """Sorts what a launch file starts, and puts the scenario together."""

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
        self._frames: list[tuple[StaticTransform, LaunchedProcess]] = []
        self._worlds: list[tuple[WorldStart, Place]] = []
        self._plans: list[RobotPlan] = []

    def build(self, time_step: float | None) -> LaunchedTwin:
        """The scenario.

        Raises:
            InputError: there is no robot.
        """
        found = LaunchedRobots(self._processes, self._packages)
        self._findings += found.findings
        self._log += found.warnings
        for process in self._processes:
            self._sort(process, found)
        self._findings += _what_never_came(self._launched, self._file)
        if not found.robots:
            raise self._no_robot()
        robots = self._robots(found)
        world, step = self._world(found)
        step = time_step or step or 0.001
        scenario = Scenario(
            robots=tuple(robots),
            time_step=step,
            world=world,
            package_paths=self._folders,
            static_transforms=tuple(self._usable_frames()),
            commands=tuple(_not_faster(command, step) for command in self._commands),
            findings=tuple(merged(self._findings)),
        )
        paused = bool(self._worlds) and self._worlds[-1][0].paused
        return LaunchedTwin(scenario, paused, found.only_displayed, tuple(self._log))

    def _sort(self, process: LaunchedProcess, found: LaunchedRobots) -> None:
        try:
            requests = controller_requests(process)
            commands = published_commands(process)
            if requests is not None:
                self._requests += requests
            elif commands is not None:
                self._commands += commands
            elif process.executable == "static_transform_publisher":
                self._frames.append((static_frame(process), process))
            elif (world := process.world if process.kind == WORLD else _world_of_command(process)) is not None:
                self._worlds += [] if world.window_only else [(world, process.place)]
            elif not (
                is_spawner(process)
                or is_state_publisher(process)
                or (process.package, process.executable) in _BUILT_IN
                or (found.only_displayed and process.executable.startswith("joint_state_publisher"))
            ):
                self._drop(why_not_started(process), process, Kind.WINDOW if is_window(process) else Kind.NOT_STARTED)
        except InputError as error:
            self._drop(f"{process.what}: {error}", process)

    def _drop(self, what: str, process: LaunchedProcess, kind: Kind = Kind.NOT_STARTED) -> None:
        """Notes what is not started, with the place that asks for it."""
        self._findings.append(Finding.at(kind, what, process.place))

    def _usable_frames(self) -> Iterator[StaticTransform]:
        """The static transforms that leave each frame, those of the robots included, one parent."""
        parents = {
            plan.frame_prefix + joint.child: plan.frame_prefix + joint.parent
            for plan in self._plans
            for joint in plan.description.joints
        }
        for frame, process in self._frames:
            if frame.child in parents:
                reason = f"it hangs on {parents[frame.child]!r} already"
            elif frame.child in _ancestors(frame.parent, parents):
                reason = "it would hang on itself"
            else:
                parents[frame.child] = frame.parent
                yield frame
                continue
            self._drop(f"{process.what} (frame {frame.child!r}: {reason})", process)

    def _robots(self, found: LaunchedRobots) -> list[Robot]:
        robots: list[Robot] = []
        managers = _by_manager(found.robots, self._requests, self._findings, self._log)
        links: dict[str, str] = {}
        taken: set[str] = set()
        for launched in found.robots:
            name = _plain_name(launched.name)
            requests = managers.get(launched.name, [])
            namespace = launched.namespace
            if any(robot.namespace == namespace for robot in robots):
                namespace = f"{namespace.rstrip('/')}/{name}"
                self._log.append(f"{name}: another robot has its namespace, so that its topics are below {namespace}")
            prefix = _frame_prefix(launched)
            if any(prefix + link in links for link in launched.links if prefix + link != "world"):
                prefix = f"{name}/"
                self._log.append(
                    f"{name}: another robot has frames of the same names, so that its own begin with {prefix}"
                )
            links.update(dict.fromkeys((prefix + link for link in launched.links), name))
            if launched.process.start_time > 0:
                self._log.append(f"{name}: it is spawned after {launched.process.start_time:g} s; here from the start")
            pose = launched.pose
            robot = Robot(
                name=name,
                model=launched.model,
                xyz=(0.0, 0.0, 0.0) if pose is None else pose.xyz,
                rpy=(0.0, 0.0, 0.0) if pose is None else pose.rpy,
                namespace=namespace,
                frame_prefix=prefix,
                controllers=self._parameter_files(launched, requests),
                active_controllers=tuple(dict.fromkeys(item.name for item in requests if item.active)),
                inactive_controllers=_inactive(requests),
                remappings={
                    own: topic
                    for own, topic in self._remappings(launched, requests, namespace).items()
                    if topic not in taken
                },
            )
            asked = {request.name: request.process for request in requests}
            plan = self._planned(robot, asked, only_displayed=found.only_displayed, on_ground=pose is None)
            taken |= _topics_of(plan)
            self._plans.append(plan)
            robots.append(plan.robot)
        return robots

    def _parameter_files(self, launched: LaunchedRobot, requests: Sequence[ControllerRequest]) -> tuple[str, ...]:
        given = []
        for request in requests:
            error = check_parameter_files(request)
            if error is None:
                given += [self._filled_in(Path(file)) for file in request.parameter_files]
            else:
                self._drop(f"controller {request.name}: {error}", request.process)
        if not given:
            return launched.parameter_files
        return tuple(dict.fromkeys((*(launched.parameter_files or launched.plugin_files), *given)))

    def _filled_in(self, file: Path) -> str:
        """A parameters file that a spawner is given, with the launch configurations for its ``$(var name)``."""
        text = file.read_text(encoding="utf-8", errors="replace")
        known = self._launched.configurations
        filled = re.sub(r"\$\(var\s+([\w.]+)\s*\)", lambda match: known.get(match[1], match[0]), text)
        return str(file) if filled == text else parameter_file(ParameterText(file, filled))

    def _planned(
        self, robot: Robot, asked: Mapping[str, LaunchedProcess], *, only_displayed: bool, on_ground: bool
    ) -> RobotPlan:
        """The robot without the controllers that its parameters files lack, which a spawner would wait for in vain.

        One that is only displayed has its broadcaster of joint states in place of a joint_state_publisher.
        """
        from drake_twin.controllers.types import JOINT_STATE_BROADCASTER
        from drake_twin.planning.controller_plan import ControllerError
        from drake_twin.planning.robot_plan import plan_robot

        while True:
            try:
                plan = plan_robot(robot, self._packages)
            except (ScenarioError, ControllerError) as error:
                if isinstance(error, ControllerError):
                    name, reason = error.controller, str(error)
                elif error.path[-1] in ("active_controllers", "inactive_controllers"):
                    name, reason = str(error.more.get("value")), error.reason
                else:
                    raise
                if name not in (*(robot.active_controllers or ()), *robot.inactive_controllers):
                    raise
                self._drop(f"controller {name} of {robot.name}: {reason}", asked[name])
                robot = replace(
                    robot,
                    active_controllers=tuple(item for item in robot.active_controllers or () if item != name),
                    inactive_controllers=tuple(item for item in robot.inactive_controllers if item != name),
                )
                continue
            if only_displayed:
                names = [item.name for item in plan.controllers if item.type == JOINT_STATE_BROADCASTER]
                robot = replace(robot, active_controllers=tuple(names[:1]))
            elif on_ground and not plan.model.is_fixed:
                from drake_twin.builder.robot_file import height_on_ground

                robot = replace(robot, xyz=(0.0, 0.0, height_on_ground(plan)))
            return replace(plan, robot=robot)

    def _remappings(
        self, launched: LaunchedRobot, requests: Sequence[ControllerRequest], namespace: str
    ) -> dict[str, str]:
        """Topics that the launch file gives another name.

        They are the controllers' by what their spawners or the ros2_control_node say, the description's, and Gazebo's
        own through a bridge.
        """
        found = {}
        own = namespace.rstrip("/")
        for request in requests:
            node = f"{own}/{request.name}"
            for source, target in request.remappings:
                found[absolute_name(source, namespace, node)] = absolute_name(target, namespace, node)
        if launched.process.executable == "ros2_control_node":  # the controllers are nodes of its process
            for source, target in launched.process.remappings:
                if not source.startswith("~"):
                    found[absolute_name(source, namespace)] = absolute_name(target, namespace)
        if launched.publisher is not None:
            topic = launched.publisher.resolve("robot_description")
            if topic != f"{own}/robot_description":
                found[f"{own}/robot_description"] = topic
        for process in self._processes:
            if (process.package, process.executable) in _BUILT_IN and process.executable == "parameter_bridge":
                found |= _bridged(process)
        return found

    def _world(self, found: LaunchedRobots) -> tuple[World, float | None]:
        if found.only_displayed:
            return World(gravity=(0.0, 0.0, 0.0), ground=False), None
        started = next(((world.world, place) for world, place in reversed(self._worlds) if world.world), None)
        if started is None:
            return World(), None
        name, place = started
        from drake_twin.description.world_file import read_world

        try:
            address = _address(name, self._file)
            world = read_world(address, self._packages)
        except InputError as error:
            self._findings.append(Finding.at(Kind.NOT_STARTED, f"world {name}: {error}", place))
            return World(), None
        step = world.max_step_size
        usable = step is not None and SHORTEST_STEP <= step <= LONGEST_STEP
        return World(file=address), step if usable else None

    def _no_robot(self) -> InputError:
        text = "the launch file starts no robot"
        if self._requests:
            names = ", ".join(dict.fromkeys(request.name for request in self._requests))
            text += f" for its controllers ({names}): it is a part of a launch, to be included where a robot is"
        if self._launched.shutdown is not None:
            text += f": it ends itself ({self._launched.shutdown})"
        reasons = dict.fromkeys(item.what for item in self._findings if item.kind is Kind.NOT_STARTED)
        if reasons:
            text += f". Not started: {'; '.join(reasons)}"
        if self._launched.absent_packages:
            text += (
                f". Absent packages: {', '.join(self._launched.absent_packages)}: name the folders that hold them with"
                " --package-path"
            )
        return InputError(text, file=self._file)


def _folders_of(file: Path, processes: Iterable[LaunchedProcess]) -> Iterable[str]:
    """Folders where the launch files' own packages stand, and those of Gazebo's search paths."""
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


def _by_manager(
    robots: Sequence[LaunchedRobot], requests: Sequence[ControllerRequest], findings: list[Finding], log: list[str]
) -> dict[str, list[ControllerRequest]]:
    """Robot → the requests to its controller manager."""
    controlled = [robot for robot in robots if robot.controller_manager is not None]
    found: dict[str, list[ControllerRequest]] = {}
    for request in requests:
        owners = [robot for robot in controlled if robot.controller_manager == request.manager]
        namespace = request.manager.rpartition("/")[0]
        # A manager of another name is meant all the same where no other can be.
        owners = owners or [robot for robot in controlled if namespace.strip("/") == robot.name]
        owners = owners or (controlled if len(controlled) == 1 else [])
        if not owners:
            known = ", ".join(str(robot.controller_manager) for robot in controlled) or "none"
            why = f"{request.process.what}: there is no {request.manager}; there is {known}"
            what = f"controller {request.name} ({why})"
            findings.append(Finding.at(Kind.NOT_STARTED, what, request.process.place))
            continue
        manager = str(owners[0].controller_manager)
        assumed = f"{request.process.what} waits for {request.manager}, and there is {manager}: it is taken"
        if manager != request.manager and assumed not in log:
            log.append(assumed)
        found.setdefault(owners[0].name, []).append(request)
    return {name: _settled(items) for name, items in found.items()}


def _settled(requests: Iterable[ControllerRequest]) -> list[ControllerRequest]:
    """What holds after all requests: the last word on each controller, an unspawner's included."""
    last: dict[str, ControllerRequest] = {}
    for request in requests:
        if request.unload:
            last.pop(request.name, None)
        else:
            before = last.pop(request.name, None)
            files = (*(before.parameter_files if before else ()), *request.parameter_files)
            remappings = (*(before.remappings if before else ()), *request.remappings)
            last[request.name] = replace(request, parameter_files=files, remappings=remappings)
    return list(last.values())


def _not_faster(command: Command, step: float) -> Command:
    """A command that is published at most once a step."""
    return command if command.period is None else replace(command, period=max(command.period, step))


def _topics_of(plan: RobotPlan) -> set[str]:
    """The topics that a robot has, and another one cannot have too."""
    from drake_twin.diagram.twin_diagram import ROBOT_TOPICS

    robot, namespace = plan.robot, plan.robot.topic_namespace
    names = [f"{namespace}/{name}" for name in ROBOT_TOPICS]
    for item in plan.controllers:
        names += [name for name in robot.remappings if name.startswith(f"{namespace}/{item.name}/")]
        names += ["/" + name.format(model=robot.name).lstrip("/") for name in item.gz_topics.values()]
        names += [absolute_name(name, namespace) for name in (item.topics or {}).values() if name]
    return {robot.remapped(name) for name in names}


def _inactive(requests: Sequence[ControllerRequest]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(item.name for item in requests if not item.active))


def _frame_prefix(robot: LaunchedRobot) -> str:
    prefix = "" if robot.publisher is None else parameters(robot.publisher).get("frame_prefix", "")
    return prefix if isinstance(prefix, str) else ""


def _bridged(process: LaunchedProcess) -> dict[str, str]:
    """Gazebo topic → the ROS topic that a parameter_bridge makes of it, where the names differ."""
    found = {}
    for word in process.arguments:
        topic = word.partition("@")[0]
        if "@" in word and process.resolve(topic) != topic:
            found[topic if topic.startswith("/") else f"/{topic}"] = process.resolve(topic)
    files: list[Any] = [parameters(process).get("config_file")]
    for file in files:
        if isinstance(file, str) and Path(file).is_file():
            found |= _bridge_file(Path(file), process)
    return found


def _bridge_file(file: Path, process: LaunchedProcess) -> dict[str, str]:
    from drake_twin.description.yaml_document import YamlDocument

    entries = YamlDocument(file.read_text(encoding="utf-8"), file).data
    found = {}
    for entry in entries if isinstance(entries, list) else []:
        if isinstance(entry, dict):
            ros = str(entry.get("ros_topic_name") or entry.get("topic_name") or "")
            gz = str(entry.get("gz_topic_name") or entry.get("topic_name") or ros)
            if ros and gz:
                found["/" + gz.strip("/")] = process.resolve(ros)
    return {gz: ros for gz, ros in found.items() if gz != ros}


def _world_of_command(process: LaunchedProcess) -> WorldStart | None:
    """The simulator that a command starts: ``gz sim …``, ``ign gazebo …``, ``gzserver …``, ``gazebo …``."""
    from drake_twin.ros2.built_in_packages import world_of_gz_args

    words = words_of(process)
    if words[:2] in (["gz", "sim"], ["ign", "gazebo"]):
        return world_of_gz_args(shlex.join(words[2:]))
    if words[0] in ("gzserver", "gazebo"):
        files = [word for word in words[1:] if word.endswith((".world", ".sdf"))]
        return WorldStart("classic", files[0] if files else None, paused="-u" in words or "--pause" in words)
    if words[0] == "gzclient" or words[:2] == ["gz", "client"]:
        return WorldStart("classic", window_only=True)
    return None


def _address(name: str, launch_file: Path) -> str:
    """A world as a scenario names it."""
    if "://" in name or Path(name).is_absolute():
        return name
    beside = launch_file.parent / name
    return str(beside.absolute()) if beside.is_file() else name


def _what_never_came(launched: Launched, file: Path) -> Iterator[Finding]:
    for include in launched.failed_includes:
        yield Finding.at(Kind.NOT_STARTED, f"include {include.what} ({include.reason})", include.place)
    for handler in launched.unfired_handlers:
        yield Finding.at(Kind.NOT_STARTED, f"event handler ({handler.what} never happens)", handler.place)
    for name in launched.undeclared_arguments:
        yield Finding.at(Kind.NOT_STARTED, f"argument {name} (no file declares it)", Place(str(file)))


def _ancestors(frame: str, parents: Mapping[str, str]) -> set[str]:
    found = {frame}
    while frame in parents and parents[frame] not in found:
        frame = parents[frame]
        found.add(frame)
    return found


def _plain_name(name: str) -> str:
    """An entity's name as a robot's name in the twin."""
    from drake_twin.builder.robot_file import name_in_twin

    return name_in_twin(name)
