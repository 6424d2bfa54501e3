"""The robots that a launch file starts: their descriptions, poses and controller managers."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain, count
from pathlib import Path
from typing import Any

import yaml

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_plugins import is_ros2_control, read_plugins
from drake_twin.description.included_model import included_model
from drake_twin.description.lasting_files import lasting_file
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import GazeboPlugin, Pose
from drake_twin.description.source_file import read_xml, with_prefixes
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind, Weight
from drake_twin.from_launch.command_line import CommandLine, command_line
from drake_twin.from_launch.launched_controllers import ControllerRequest
from drake_twin.from_launch.launched_world import LaunchedWorld
from drake_twin.from_launch.spawned_file import spawned_file
from drake_twin.ros2.launched import LaunchedProcess, ParameterText, absolute_name
from drake_twin.scenario import name_in_twin
from drake_twin.values import is_true

_POSE = ("x", "y", "z", "R", "P", "Y")
_CREATE = ("world", "file", "param", "string", "topic", "name", "allow_renaming", *_POSE)
_SPAWN_ENTITY = (
    *("file", "topic", "database", "stdin", "entity", "reference_frame", "gazebo_namespace", "robot_namespace"),
    *("timeout", "unpause", "wait", "spawn_service_timeout", "J", "package_to_model", "b", "h", "help", *_POSE),
)

# The nodes that spawn an entity → the options that they have.
_SPAWNERS = {
    ("ros_gz_sim", "create"): _CREATE,
    ("ros_ign_gazebo", "create"): _CREATE,
    ("gazebo_ros", "spawn_entity.py"): _SPAWN_ENTITY,
    ("gazebo_ros", "spawn_entity"): _SPAWN_ENTITY,
}


@dataclass(frozen=True)
class LaunchedRobot:
    """A robot that a launch file starts.

    Attributes:
        name: The entity's name as given.
        model: Its file, which may be written from the description's text.
        process: The process that starts it.
        pose: The spawn pose; None for on the ground at the origin.
        namespace: The namespace of its controllers and topics; ``/`` for the root.
        controller_manager: The full name of its controller manager's node; None without ros2_control.
        parameter_files: Its controllers' parameters files, if the launch file has them and not the description.
        plugin_files: The parameters files in its description.
        publisher: The robot_state_publisher that publishes its description.
        links: The names of its links.
        self_collides: Whether they touch each other in Gazebo Sim, whose engine reads only the flag of an SDF model.
        has_colliding_links: Whether a link has such a flag.
    """

    name: str
    model: str
    process: LaunchedProcess
    pose: Pose | None
    namespace: str
    controller_manager: str | None
    parameter_files: tuple[str, ...] = ()
    plugin_files: tuple[str, ...] = ()
    publisher: LaunchedProcess | None = None
    links: frozenset[str] = frozenset()
    self_collides: bool = False
    has_colliding_links: bool = False


@dataclass(frozen=True)
class _Source:
    """A description: its file and the parts that are needed here."""

    model: str
    text: str
    plugins: tuple[GazeboPlugin, ...]
    links: frozenset[str]
    name: str
    has_hardware: bool
    self_collides: bool
    has_colliding_links: bool


def is_spawner(process: LaunchedProcess) -> bool:
    """Return whether a node spawns an entity."""
    return (process.package, process.executable) in _SPAWNERS


def is_state_publisher(process: LaunchedProcess) -> bool:
    """Return whether a node is a robot_state_publisher."""
    return process.executable == "robot_state_publisher"


class LaunchedRobots:
    """Find the robots in what a launch file starts.

    Args:
        processes: The processes that it starts.
        packages: Resolves file addresses.

    Attributes:
        robots: The robots, in the order of their start.
        findings: The findings of robots that cannot be started, each with the reason.
        warnings: The assumptions made.
        absent_managers: The controller managers beside a simulator, which are not started.
    """

    def __init__(self, processes: Sequence[LaunchedProcess], packages: PackageIndex):
        self._packages = packages
        self._publishers = [process for process in processes if is_state_publisher(process)]
        self.robots: list[LaunchedRobot] = []
        self.findings: list[Finding] = []
        self.warnings: list[str] = []
        self.absent_managers: set[str] = set()
        for process in processes:
            if is_spawner(process):
                self._try(self._spawned, process)
        for process in processes:
            if process.executable == "ros2_control_node":
                self._try(self._without_simulator, process)
        if not self.robots:
            for process in self._publishers:
                self._try(self._displayed, process)

    @property
    def only_displayed(self) -> bool:
        """Whether nothing is spawned or controlled, so that the robots are only displayed."""
        return bool(self.robots) and all(is_state_publisher(robot.process) for robot in self.robots)

    def add_those_of_world(self, world: LaunchedWorld) -> None:
        """Add the robots that stand in the world's file, in place of a robot that is only displayed.

        As in Gazebo, a robot that is spawned under the name of a model of the world is refused.
        """
        for robot in [robot for robot in self.robots if robot.name in world.names and is_spawner(robot.process)]:
            self.robots.remove(robot)
            self._drop(f"{robot.process.what}: the world has a model named {robot.name!r} already", robot.process)
        if world.process is None or not world.robots:
            return
        if self.only_displayed and not all(model.is_static for model in world.robots):
            self.robots.clear()
        for model in world.robots:
            assert model.robot is not None
            path = lasting_file(model.robot.file, model.robot.text)
            source = _read(str(path), model.robot.text, path)
            is_described = len(self._publishers) == 1 and not model.is_static  # a conveyor is nobody's description
            publisher = self._publishers[0] if is_described else None
            self._add(model.name, source, world.process, model.pose, publisher, "")

    def _try(self, make: Any, process: LaunchedProcess) -> None:
        try:
            make(process)
        except InputError as error:
            self._drop(f"{process.what}: {str(error).rstrip('.')}", process)

    def _spawned(self, process: LaunchedProcess) -> None:
        flags, is_gflags = ("allow_renaming", "unpause", "wait", "b"), process.package != "gazebo_ros"
        line = command_line(process, flags=flags, defaults=parameters(process), is_gflags=is_gflags)
        for option in line.unknown(_SPAWNERS[process.package or "", process.executable]):
            common = f": unknown option of {process.what}"
            # `create` calls gflags' AllowCommandLineReparsing, which skips unknown options in silence.
            kind = Kind.IGNORED if is_gflags else Kind.REFUSED_BY_ROS
            self.findings.append(Finding.at(kind, option + common, process.place, common=common))
        source, publisher = self._source(line, process)
        is_classic = process.package == "gazebo_ros"
        name = line.text("entity") if is_classic else line.text("name") or source.name
        if not name:
            raise line.error("the entity has no name: give -entity" if is_classic else "the entity has no name")
        own_namespace = line.text("robot_namespace") if is_classic else None
        if any(robot.name == name for robot in self.robots):
            others = {robot.namespace.strip("/") for robot in self.robots if robot.name == name}
            apart = own_namespace is not None and own_namespace.strip("/") not in others
            if not apart and not line.flag("allow_renaming"):
                raise line.error(f"Entity [{name}] already exists.")
        pose = Pose(
            (line.number("x"), line.number("y"), line.number("z")),
            (line.number("R"), line.number("P"), line.number("Y")),
        )
        self._add(name, source, process, pose, publisher, own_namespace or "")

    def _without_simulator(self, process: LaunchedProcess) -> None:
        """Add the robots of ros2_control_nodes, unless a simulator starts a robot."""
        source, publisher = self._described(process)
        manager = absolute_name(process.name or "controller_manager", process.namespace)
        beside = [repr(robot.name) for robot in self.robots if is_spawner(robot.process) and robot.controller_manager]
        if any(robot.publisher is publisher and publisher is not None for robot in self.robots):
            self._drop(f"{process.what} (the simulated robot has its own controller manager)", process, Weight.MOVES)
        elif beside:
            self.absent_managers.add(manager)
            what = f"{process.what} (its hardware is not in the simulator, which has {', '.join(beside)})"
            self._drop(what, process, Weight.MOVES)
        else:
            files = tuple(parameter_file(item) for item in process.parameters if not isinstance(item, Mapping))
            self._add(source.name, source, process, None, publisher, process.namespace)
            self.robots[-1] = replace(
                self.robots[-1], namespace=process.namespace, controller_manager=manager, parameter_files=files
            )

    def _displayed(self, process: LaunchedProcess) -> None:
        source = self._text_source(_description_of(process))
        if any((robot.model, robot.namespace) == (source.model, process.namespace) for robot in self.robots):
            return  # a duplicate
        name = process.namespace.strip("/").replace("/", "_") or source.name
        self._add(name, source, process, None, process, process.namespace)
        self.robots[-1] = replace(self.robots[-1], controller_manager=None, namespace=process.namespace)

    def _add(
        self,
        name: str,
        source: _Source,
        process: LaunchedProcess,
        pose: Pose | None,
        publisher: LaunchedProcess | None,
        given_namespace: str,
    ) -> None:
        control = [plugin for plugin in source.plugins if is_ros2_control(plugin)]
        wanted = [plugin.namespace for plugin in control or source.plugins if plugin.namespace]
        namespace = "/" + (given_namespace or next(iter(wanted), "")).strip("/")
        manager = None
        taken = {name_in_twin(robot.name) for robot in self.robots}  # team/r and team_r have one name there
        numbered = chain((name,), (f"{name}_{number}" for number in count(1)))
        name = next(each for each in numbered if name_in_twin(each) not in taken)
        if control or source.has_hardware:
            names = [_element(plugin, "controller_manager_name", "controller_manager_node_name") for plugin in control]
            manager = absolute_name(next(filter(None, names), "controller_manager"), namespace)
        self.robots.append(
            LaunchedRobot(
                name=name,
                model=source.model,
                process=process,
                pose=pose,
                namespace=namespace,
                controller_manager=manager,
                plugin_files=tuple(file for plugin in control for file in plugin.parameters),
                publisher=publisher,
                links=source.links,
                self_collides=source.self_collides,
                has_colliding_links=source.has_colliding_links,
            )
        )

    def _source(self, line: CommandLine, process: LaunchedProcess) -> tuple[_Source, LaunchedProcess | None]:
        """Return an entity's description, and the robot_state_publisher that publishes it, if any."""
        file, text, topic, parameter = (line.text(name) for name in ("file", "string", "topic", "param"))
        if file is not None:
            return self._with_controlled_description(self._file_source(file, process), process)
        if text is not None:
            return self._text_source(text), None
        if parameter is not None:
            given = parameters(process).get(parameter)
            if isinstance(given, str) and given.strip():
                return self._text_source(given), None
            raise line.error(f"-param {parameter}: the node does not have this parameter")
        if topic is None:
            raise line.error("one of -topic, -file, -string and -param is needed")
        return self._published(line, process, topic)

    def _published(
        self, line: CommandLine, process: LaunchedProcess, topic: str
    ) -> tuple[_Source, LaunchedProcess | None]:
        full = process.resolve(topic)
        for publisher in self._publishers:
            if publisher.resolve("robot_description") == full:
                return self._text_source(_description_of(publisher)), publisher
        if len(self._publishers) == 1:
            (publisher,) = self._publishers
            there = publisher.resolve("robot_description")
            self.warnings.append(f"{process.what} waits for {full}; the description on {there} is used instead")
            return self._text_source(_description_of(publisher)), publisher
        topics = [publisher.resolve("robot_description") for publisher in self._publishers]
        raise process.error(f"no node publishes a description on {full}", value=full, valid=topics or None)

    def _with_controlled_description(
        self, source: _Source, process: LaunchedProcess
    ) -> tuple[_Source, LaunchedProcess | None]:
        """Return the description that the ros2_control plugin of an SDF reads from another node; else the SDF."""
        control = [plugin for plugin in source.plugins if is_ros2_control(plugin)]
        if source.has_hardware or not control:
            publisher = next((item for item in self._publishers if item.namespace == process.namespace), None)
            return source, publisher if len(self._publishers) == 1 else None
        node = _element(control[0], "robot_param_node") or "robot_state_publisher"
        for publisher in self._publishers:
            if publisher.full_name.rpartition("/")[2] == node.rpartition("/")[2]:
                self.warnings.append(
                    f"{process.what}: {Path(source.model).name} has no <ros2_control>: the robot of"
                    f" {publisher.full_name} replaces it"
                )
                return self._text_source(_description_of(publisher)), publisher
        return source, None

    def _described(self, process: LaunchedProcess) -> tuple[_Source, LaunchedProcess | None]:
        """Return the description of a ros2_control_node."""
        given = parameters(process).get("robot_description")
        topics = {process.resolve("~/robot_description"), process.resolve("robot_description")}
        publisher = next(
            (item for item in self._publishers if item.resolve("robot_description") in topics),
            self._publishers[0] if len(self._publishers) == 1 else None,
        )
        if isinstance(given, str) and given.strip():
            return self._text_source(given), publisher
        if publisher is None:
            raise process.error("it has no robot_description, and no node publishes one")
        return self._text_source(_description_of(publisher)), publisher

    def _drop(self, what: str, process: LaunchedProcess, weight: Weight = Weight.LOST) -> None:
        self.findings.append(Finding.at(Kind.NOT_STARTED, what, process.place, weight=weight))

    def _file_source(self, file: str, process: LaunchedProcess) -> _Source:
        text, path = spawned_file(file, process, self._packages)
        return _read(str(path), *included_model(with_prefixes(text), path, self._packages)[:2])

    def _text_source(self, text: str) -> _Source:
        """Return a description's text as a file of the cache, at the same path in every run."""
        suffix = "sdf" if "<sdf" in text[:2000] else "urdf"
        path = lasting_file(f"robot.{suffix}", text)
        return _read(str(path), *included_model(with_prefixes(text), path, self._packages)[:2])


def parameters(process: LaunchedProcess) -> dict[str, Any]:
    """Return a node's parameters in the launch file; later ones override earlier ones."""
    merged: dict[str, Any] = {}
    for item in process.parameters:
        if isinstance(item, Mapping):
            merged.update(item)
    return merged


def parameter_file(item: Path | ParameterText) -> str:
    """Return a parameters file's path; a rewritten file is put into the cache."""
    if isinstance(item, ParameterText):
        return str(lasting_file(item.file.name, item.text))
    return str(item)


def _description_of(publisher: LaunchedProcess) -> str:
    """Return the text that a robot_state_publisher publishes: its parameter, or the file on its command line."""
    given = parameters(publisher).get("robot_description")
    if isinstance(given, str) and given.strip():
        return given
    for word in publisher.arguments:
        path = Path(word)
        if path.suffix in (".urdf", ".sdf", ".xml") and path.is_file():
            return read_xml(path, "robot file")
    raise publisher.error("it has no robot_description")


def _read(model: str, text: str, path: Path) -> _Source:
    reader = XmlReader(text, path)
    root = reader.root
    is_sdf = root.tag == "sdf"
    named = root.find("model") if is_sdf else root
    name = "" if named is None else named.get("name", "")
    links = root.iterfind("model/link" if is_sdf else "link")
    return _Source(
        model=model,
        text=text,
        plugins=tuple(read_plugins(reader, "model/plugin" if is_sdf else "gazebo/plugin")),
        links=frozenset(str(link.get("name", "")) for link in links),
        name=name or "robot",
        has_hardware=any(root.find(path) is not None for path in ("ros2_control", "model/ros2_control")),
        self_collides=is_true(root.findtext("model/self_collide")),
        has_colliding_links=any(
            is_true(flag.get("value") or flag.text)
            for flag in root.iter("selfCollide", "self_collide")
            if flag.getparent() is not named
        ),
    )


def _element(plugin: GazeboPlugin, *names: str) -> str:
    """Return the text of the first of a plugin's elements that exists; empty without one."""
    return next((plugin.elements[name][0] for name in names if plugin.elements.get(name, ("",))[0]), "")


def command_line_file(request: ControllerRequest) -> list[str]:
    """Return a file with the parameters that a spawner's command line gives; none if it gives none."""
    parameters = dict(request.parameters)
    kind = parameters.pop("type", None)
    entries: dict[str, Any] = {}
    if kind is not None:
        entries["controller_manager"] = {"ros__parameters": {request.name: {"type": kind}}}
    if parameters:
        plain = {name: list(value) if isinstance(value, tuple) else value for name, value in parameters.items()}
        entries[request.name] = {"ros__parameters": plain}
    text = yaml.safe_dump(entries)
    return [parameter_file(ParameterText(Path(f"{request.name}.yaml"), text))] if entries else []
