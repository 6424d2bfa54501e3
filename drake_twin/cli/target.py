"""What the command line of ``drake_twin.run`` runs: the twin's own robots, a scenario, a robot or a launch file."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from drake_twin.cli.time_step_option import with_longest_step
from drake_twin.dataclass import dataclass
from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.description.package_index import absolute_path, share_folder
from drake_twin.description.source_file import regular_open
from drake_twin.errors import CommandError, InputError
from drake_twin.findings import Finding
from drake_twin.program import say
from drake_twin.scenario import (
    CENIC,
    LONGEST_STEP,
    SHORTEST_STEP,
    Command,
    Robot,
    Scenario,
    ScenarioError,
    World,
    name_in_twin,
)
from drake_twin.scenario.scenario_file import ScenarioFile

if TYPE_CHECKING:
    from drake_twin.planning.robot_plan import RobotPlan
    from drake_twin.twin.recording import Recording
    from drake_twin.twin.snapshot import Snapshot
    from drake_twin.twin.twin import Twin

_LAUNCH_FILE = re.compile(r".*(\.launch|_launch|\.launch\.\w+|_launch\.\w+)$|.*\.py$")

_GRID_OF_CENIC = 0.01  # s; a finer grid would cut its steps short


@dataclass(frozen=True)
class Target:
    """What to run.

    Attributes:
        scenario: The scenario.
        file: Its file, if it was read from one.
        plans: The plans of its robots that are made already.
        snapshot: The state to continue from.
        recording: The run to replay first.
        paused: Whether the launch file starts a simulator paused.
        end: The simulation time (s) at which a timer of the launch file ends it; None without one.
        only_displayed: Whether the launch file only displays its robots, without a simulator.
        log: The messages that the launch file logs.
    """

    scenario: Scenario
    file: ScenarioFile | None = None
    plans: tuple[RobotPlan, ...] = ()
    snapshot: Snapshot | None = None
    recording: Recording | None = None
    paused: bool = False
    end: float | None = None
    only_displayed: bool = False
    log: tuple[str, ...] = ()

    def located(self, error: ScenarioError) -> InputError:
        """Return an error of building the scenario with the file and line of its value."""
        if self.file is not None:
            return self.file.located(error)
        if error.path[0] == "commands":  # of --pub, so that it is in no file
            return CommandError(error.reason, **error.more)
        return error


def find_target(options: argparse.Namespace) -> Target:
    """Return what the command line runs.

    Args:
        options: The options of ``drake_twin.run``.

    Raises:
        InputError: If options exclude each other, or a file cannot be used.
    """
    given = dict(item.split(":=", 1) for item in options.target if ":=" in item)
    words = [item for item in options.target if ":=" not in item]
    commands = tuple(_command(topic, data) for topic, data in options.pub)
    saved = options.load_state or options.replay
    launch_file = None if saved else find_launch_file(words, package_paths(options))
    if saved:
        target = _saved(options)
    elif launch_file is not None:
        if len(words) > 1:
            say(f"launch file: {launch_file}", sys.stderr)
        target = _launched(launch_file, words, options, given)
    elif len(words) > 1:
        raise InputError(f"only one scenario or robot file can be run at a time, not {', '.join(words)}")
    elif not words:
        target = Target(_demo(options, given, drive=not commands))
    elif words[0].endswith((".yaml", ".yml")):
        file = _scenario_file(words[0], options, given)
        target = Target(file.scenario, file)
    elif _is_world(_own_or(words[0])):
        target = _world_file(words[0], options, given)
    else:
        target = _robot_file(words[0], options, given)
    scenario = _with_options(target, options, commands)
    return replace(target, scenario=with_longest_step(scenario, options) if options.auto_step else scenario)


def _with_options(target: Target, options: argparse.Namespace, commands: tuple[Command, ...]) -> Scenario:
    """Return the target's scenario with the world, the engine, the step and the commands of the command line."""
    scenario = target.scenario
    if options.world is not None:
        own_step = target.file is None and options.time_step is None
        scenario = _in_world(scenario, options.world, own_step=own_step)
    if options.engine == CENIC and target.file is None:
        scenario = replace(scenario, time_step=max(scenario.time_step, _GRID_OF_CENIC))
    for name in ("engine", "accuracy", "time_step", "clock_rate", "seed", "islands", "threads"):
        if (value := getattr(options, name)) is not None:
            scenario = replace(scenario, **{name: value})
    if options.no_sensor_noise:
        scenario = replace(scenario, sensor_noise=False)
    if options.node:
        from drake_twin.cli.node_options import node_programs

        scenario = replace(scenario, nodes=(*scenario.nodes, *node_programs(options.node)))
    if commands:
        topics = {command.topic for command in commands}
        kept = tuple(command for command in scenario.commands if command.topic not in topics)
        scenario = replace(scenario, commands=kept + commands)
    return scenario


def _saved(options: argparse.Namespace) -> Target:
    """Return the target of ``--load-state`` or ``--replay``, which have their own robots."""
    from drake_twin.twin.recording import Recording
    from drake_twin.twin.snapshot import Snapshot

    if options.load_state and options.replay:
        raise InputError("--load-state and --replay cannot be combined")
    option = "--load-state" if options.load_state else "--replay"
    if options.target or options.robots is not None or options.robot or options.world or options.time_step is not None:
        raise InputError(
            f"{option} defines what is run: it cannot be combined with a target, or options of robots, world and steps"
        )
    if options.pub or {options.engine, options.accuracy, options.clock_rate, options.islands} != {None}:
        what = "it cannot be combined with --engine, --accuracy, --clock-rate, --islands or --pub"
        raise InputError(f"{option} continues as it was saved: {what}")
    if options.node:
        raise InputError(f"{option} continues as it was saved, with its nodes: it cannot be combined with --node")
    if options.seed is not None or options.no_sensor_noise:
        raise InputError(f"{option} continues as it was saved: it cannot be combined with --seed or --no-sensor-noise")
    if options.load_state:
        snapshot = Snapshot.load(options.load_state)
        return Target(ScenarioFile(snapshot.scenario, options.load_state).scenario, snapshot=snapshot)
    recording = Recording.load(options.replay)
    return Target(ScenarioFile(recording.start.scenario, options.replay).scenario, recording=recording)


def target_name(options: argparse.Namespace) -> str:
    """Return a short name of what the command line runs: a file's without its suffixes, or the robot's."""
    words = [item for item in options.target if ":=" not in item]
    if not words:
        return options.robot or "rover"
    name = Path(words[-1]).name.split(".")[0].strip()
    return "".join(letter if letter.isprintable() else "_" for letter in name) or "twin"


def build_twin(target: Target) -> Twin:
    """Build the twin of a target.

    Raises:
        InputError: If the scenario cannot be built, with the file and line of the invalid value.
    """
    from drake_twin.twin.replay import replay
    from drake_twin.twin.twin import Twin

    if target.recording is not None:
        return replay(target.recording)
    try:
        twin = Twin(target.scenario, plans=target.plans)
        if target.snapshot is not None:
            twin.restore(target.snapshot)
    except ScenarioError as error:
        raise target.located(error) from None
    return twin


def package_paths(options: argparse.Namespace) -> list[str]:
    """Return the package folders that the command line names."""
    folders = [absolute_path(folder) for folder in options.package_path]
    if options.workspace:
        from drake_twin.description.package_index import workspace_folders

        folders += [str(folder) for workspace in options.workspace for folder in workspace_folders(workspace)]
    return folders


def find_launch_file(words: Sequence[str], folders: Sequence[str]) -> Path | None:
    """Return the launch file that the command line names, as a path or as ``PACKAGE FILE``; None without one.

    Raises:
        InputError: If the package, or the launch file in it, does not exist.
    """
    if len(words) == 2 and _LAUNCH_FILE.match(words[1]) and "/" not in words[0]:
        return _launch_file_of_package(words[0], words[1], folders)
    if len(words) != 1:
        return None
    file = _own_or(words[0])
    is_launch_file = _LAUNCH_FILE.match(file.name) or (file.suffix in (".xml", ".yaml", ".yml") and _is_launch(file))
    return file if is_launch_file else None


def _launch_file_of_package(package: str, name: str, folders: Sequence[str]) -> Path:
    from drake_twin.description.package_index import PackageIndex, surrounding_workspace, workspace_folders

    workspace = surrounding_workspace(Path.cwd())
    around = [] if workspace is None else workspace_folders(workspace)
    share = PackageIndex([*folders, *around]).find(package, Path.cwd() / "here")
    found = sorted(path for path in share.rglob("*") if path.is_file() and _LAUNCH_FILE.match(path.name))
    found = [path for path in found if path.suffix != ".py" or "launch" in path.name or path.parent.name == "launch"]
    for path in found:
        if path.name == name:
            return path
    names = dict.fromkeys(path.name for path in found)
    raise InputError(f"package {package!r} has no launch file {name!r}", value=name, valid=names)


def _is_launch(file: Path) -> bool:
    """Return whether an XML or YAML file whose name does not show it is a launch file."""
    return re.search(r"^\s*<launch\b|^launch\s*:", _start_of(file), re.MULTILINE) is not None


def _is_world(file: Path) -> bool:
    """Return whether a file is a world of SDF."""
    if file.suffix not in (".sdf", ".world"):
        return False
    text = re.sub(r"<!--.*?-->|<!\[CDATA\[.*?\]\]>", "", _start_of(file), flags=re.DOTALL)
    return re.search(r"<sdf\b[^>]*>\s*<world\b", text) is not None


def _start_of(file: Path) -> str:
    """Read a file's start; nothing of one that cannot be read."""
    try:
        with regular_open(file, encoding="utf-8", errors="replace") as stream:
            return str(stream.read(8000))
    except OSError:
        return ""


def _launched(file: Path, words: list[str], options: argparse.Namespace, arguments: Mapping[str, str]) -> Target:
    from drake_twin.builder.launch_file import launch_file_scenario

    if options.robots is not None or options.robot is not None:
        raise InputError(f"{file.name} defines its robots: it cannot be combined with --robots or --robot")
    folders, step = package_paths(options), options.time_step
    launched = launch_file_scenario(file, arguments, folders, time_step=step, words=words)
    return Target(
        launched.scenario,
        plans=launched.plans,
        paused=launched.paused,
        end=launched.end,
        only_displayed=launched.only_displayed,
        log=launched.log,
    )


def _demo(options: argparse.Namespace, xacro_args: dict[str, str], *, drive: bool) -> Scenario:
    from drake_twin.builder.demo import DEMOS, demo_scenario

    robot = options.robot or "rover"
    if robot not in DEMOS:
        raise InputError(f"--robot {robot}: unknown robot", value=robot, valid=DEMOS)
    if xacro_args:
        raise InputError(f"{_as_typed(xacro_args)}: xacro arguments need a robot file")
    scenario = demo_scenario(robot, options.robots or 2, drive=drive)
    folders = tuple(package_paths(options))
    return replace(scenario, package_paths=folders) if folders else scenario


def _own_or(name: str) -> Path:
    """Return the file of a name; ``diagrams/…`` is one of the package's own if the file does not exist."""
    file = Path(absolute_path(name))
    if Path(name).parts[:1] == ("diagrams",) and not file.exists():
        return share_folder("diagrams").joinpath(*Path(name).parts[1:])
    return file


def _scenario_file(name: str, options: argparse.Namespace, xacro_args: dict[str, str]) -> ScenarioFile:
    if (
        xacro_args
        or options.robots is not None
        or options.robot is not None
        or options.package_path
        or options.workspace
    ):
        raise InputError(
            f"{name} defines its robots: it cannot be combined with --robots, --robot, --package-path, --workspace or"
            " name:=value"
        )
    return ScenarioFile.read(_own_or(name))


def _robot_file(name: str, options: argparse.Namespace, xacro_args: dict[str, str]) -> Target:
    from drake_twin.builder.robot_file import planned_robots
    from drake_twin.description.package_index import PackageIndex

    if options.robot is not None:
        raise InputError(f"--robot {options.robot} names one of the twin's own robots: omit it to run {name}")
    file = PackageIndex(package_paths(options)).resolve(name)
    if file.is_dir():
        raise InputError("expected a robot file, but this is a folder", file=file)
    planned = planned_robots(file, options.robots, xacro_args=xacro_args, package_paths=package_paths(options))
    return Target(planned.scenario, plans=planned.plans)


def _world_file(name: str, options: argparse.Namespace, xacro_args: dict[str, str]) -> Target:
    """Return a world with the robots that stand in it, as ``gz sim`` starts it."""
    if options.world is not None or options.robots is not None or options.robot is not None or xacro_args:
        what = f"{name} is a world: it cannot be combined with --world, --robots, --robot or name:=value"
        raise InputError(f"{what}; --world {name} puts it around other robots")
    folders = tuple(package_paths(options))
    read = _ReadWorld.of(str(_own_or(name)), folders)
    if read.absent and not read.has_models:
        absent = "".join(f". {item}" for item in read.absent)
        raise InputError(f"none of this world's models is there{absent}", file=_own_or(name))
    world = World(file=read.file, without_models=read.without_models)
    scenario = Scenario(robots=read.robots, world=world, package_paths=folders)
    return Target(scenario if read.time_step is None else replace(scenario, time_step=read.time_step))


def _in_world(scenario: Scenario, address: str, *, own_step: bool) -> Scenario:
    """Return the scenario with the world of a file and the robots in it, and with its step if ``own_step`` is set."""
    read = _ReadWorld.of(address if "://" in address else absolute_path(address), scenario.package_paths)
    if own_step and read.time_step is not None:
        scenario = replace(scenario, time_step=read.time_step)
    world = replace(scenario.world, file=read.file, without_models=read.without_models)
    return replace(scenario, world=world, robots=(*scenario.robots, *read.robots))


class _ReadWorld(NamedTuple):
    """A world's file, its models that are robots, its step if usable (s), these, absent models, if it has any."""

    file: str
    without_models: tuple[str, ...]
    time_step: float | None
    robots: tuple[Robot, ...]
    absent: tuple[Finding, ...]
    has_models: bool

    @classmethod
    def of(cls, address: str, folders: Sequence[str]) -> _ReadWorld:
        from drake_twin.description.lasting_files import lasting_file
        from drake_twin.description.package_index import PackageIndex
        from drake_twin.description.world_file import read_world

        found = read_world(address, PackageIndex(folders))
        step = found.max_step_size
        driven = [(model, model.robot) for model in found.models if model.robot is not None]
        robots = tuple(
            Robot(
                name_in_twin(model.name),
                str(lasting_file(robot.file, robot.text)),
                xyz=model.pose.xyz,
                rpy=model.pose.rpy,
            )
            for model, robot in driven
        )
        step = step if step is not None and SHORTEST_STEP <= step <= LONGEST_STEP else None
        absent = tuple(item for item in found.findings if "not found" in item.what or "not included" in item.what)
        names = tuple(model.name for model, _ in driven)
        return cls(address, names, step, robots, absent, bool(found.models))


def _command(topic: str, text: str) -> Command:
    """Return the command of ``--pub TOPIC DATA``: DATA as for ``ros2 topic pub``, or only the list of numbers."""
    import yaml

    try:
        value = load_yaml(text)
        data = value["data"] if isinstance(value, dict) and [*value] == ["data"] else value
        if isinstance(value, dict) and not isinstance(data, list):
            return Command(topic, value)
        if not isinstance(data, list) or any(isinstance(item, bool) for item in data):
            raise TypeError
        return Command(topic, tuple(float(item) for item in data))
    except (yaml.YAMLError, TypeError, ValueError, OverflowError):
        raise InputError(
            f'--pub {topic} {text!r}: the data must be a list of numbers, such as "[2, 2, 2, 2]", or the fields of a'
            ' message, such as "{twist: {linear: {x: 0.5}}}"'
        ) from None


def _as_typed(xacro_args: dict[str, str]) -> str:
    return " ".join(f"{name}:={value}" for name, value in xacro_args.items())
