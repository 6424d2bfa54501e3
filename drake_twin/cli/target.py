"""What the command line of ``drake_twin.run`` asks for: the twin's own robots, a scenario, a robot, a launch file."""

from __future__ import annotations

import argparse
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.description.package_index import absolute_path, share_folder
from drake_twin.errors import CommandError, InputError
from drake_twin.findings import Finding, Kind
from drake_twin.scenario import CENIC, LONGEST_STEP, SHORTEST_STEP, Command, Scenario, ScenarioError
from drake_twin.scenario.scenario_file import ScenarioFile

if TYPE_CHECKING:
    from drake_twin.twin.recording import Recording
    from drake_twin.twin.snapshot import Snapshot

_LAUNCH_FILE = re.compile(r".*(\.launch|_launch|\.launch\.\w+|_launch\.\w+)$|.*\.py$")


_GRID_OF_CENIC = 0.01  # s; a finer one would cut its steps short


@dataclass(frozen=True)
class Target:
    """What is to be run.

    Attributes:
        scenario: the scenario.
        file: its file, if it was read from one.
        launched_commands: what the launch file publishes.
        snapshot: the state to go on from.
        recording: the run to do again.
        paused: whether a simulator would start paused.
        only_displayed: whether there is nothing to simulate, only robots to look at.
        log: what a launch file says.
    """

    scenario: Scenario
    file: ScenarioFile | None = None
    launched_commands: tuple[Command, ...] = ()
    snapshot: Snapshot | None = None
    recording: Recording | None = None
    paused: bool = False
    only_displayed: bool = False
    log: tuple[str, ...] = ()

    def located(self, error: ScenarioError) -> InputError:
        """An error of building the scenario, at the place where its value stands."""
        if self.file is not None:
            return self.file.located(error)
        if error.path[0] == "commands":  # typed with --pub: it has no place in a file
            return CommandError(error.reason, **error.more)
        return error


def find_target(options: argparse.Namespace) -> Target:
    """What the command line asks for.

    Args:
        options: those of ``drake_twin.run``.

    Raises:
        InputError: options that do not go together, a file that cannot be used.
    """
    given = dict(item.split(":=", 1) for item in options.target if ":=" in item)
    words = [item for item in options.target if ":=" not in item]
    commands = tuple(_command(topic, data) for topic, data in options.pub)
    saved = options.load_state or options.replay
    launch_file = None if saved else find_launch_file(words, package_paths(options))
    if saved:
        target = _saved(options)
    elif launch_file is not None:
        target = _launched(launch_file, options, given)
    elif len(words) > 1:
        raise InputError(f"one scenario or robot file can be run at a time, but there are {', '.join(words)}")
    elif not words:
        target = Target(_demo(options, given, drive=not commands))
    elif words[0].endswith((".yaml", ".yml")):
        file = _scenario_file(words[0], options, given)
        target = Target(file.scenario, file)
    else:
        target = Target(_robot_file(words[0], options, given))
    scenario = target.scenario
    if options.world is not None:
        own_step = target.file is None and options.time_step is None
        scenario = _in_world(scenario, options.world, own_step=own_step)
    if options.engine is not None:
        scenario = replace(scenario, engine=options.engine)
        if options.engine == CENIC and target.file is None:
            scenario = replace(scenario, time_step=max(scenario.time_step, _GRID_OF_CENIC))
    if options.accuracy is not None:
        scenario = replace(scenario, accuracy=options.accuracy)
    if options.time_step is not None:
        scenario = replace(scenario, time_step=options.time_step)
    if commands:
        topics = {command.topic for command in commands}
        kept = tuple(command for command in scenario.commands if command.topic not in topics)
        scenario = replace(scenario, commands=kept + commands)
    return replace(target, scenario=scenario)


def _saved(options: argparse.Namespace) -> Target:
    """``--load-state`` and ``--replay`` bring their own robots."""
    from drake_twin.twin.recording import Recording
    from drake_twin.twin.snapshot import Snapshot

    if options.load_state and options.replay:
        raise InputError("--load-state and --replay do not go together")
    option = "--load-state" if options.load_state else "--replay"
    if options.target or options.robots is not None or options.robot or options.world or options.time_step is not None:
        raise InputError(f"{option} says itself what is run: it goes without a target and options of robots and steps")
    if options.engine is not None or options.accuracy is not None or options.pub:
        raise InputError(f"{option} goes on as it was saved: --engine, --accuracy and --pub do not go with it")
    if options.load_state:
        snapshot = Snapshot.load(options.load_state)
        return Target(ScenarioFile(snapshot.scenario, options.load_state).scenario, snapshot=snapshot)
    recording = Recording.load(options.replay)
    return Target(ScenarioFile(recording.start.scenario, options.replay).scenario, recording=recording)


def target_name(options: argparse.Namespace) -> str:
    """A short name for what the command line asks for: of a file without its endings, or of the twin's own robot."""
    words = [item for item in options.target if ":=" not in item]
    if not words:
        return options.robot or "rover"
    name = Path(words[-1]).name.split(".")[0].strip()
    return "".join(letter if letter.isprintable() else "_" for letter in name) or "twin"


def build_twin(target: Target, meshcat: Any = None) -> Any:
    """The twin of a target.

    What a launch file publishes on a topic that nobody listens to is left out, as it would be unheard in ROS.

    Raises:
        InputError: the scenario cannot be built, with the place of the value at fault.
    """
    from drake_twin.twin.recording import replay
    from drake_twin.twin.twin import Twin

    if target.recording is not None:
        return replay(target.recording, meshcat)
    scenario = target.scenario
    while True:
        try:
            twin = Twin(scenario, meshcat)
            if target.snapshot is not None:
                twin.restore(target.snapshot)
            return twin
        except ScenarioError as error:
            index = error.path[1] if error.path[0] == "commands" and len(error.path) > 1 else None
            if not isinstance(index, int) or scenario.commands[index] not in target.launched_commands:
                raise target.located(error) from None
            command = scenario.commands[index]
            scenario = replace(
                scenario,
                commands=scenario.commands[:index] + scenario.commands[index + 1 :],
                findings=(
                    *scenario.findings,
                    Finding(Kind.NOT_STARTED, f"ros2 topic pub {command.topic} ({error.reason})"),
                ),
            )


def package_paths(options: argparse.Namespace) -> list[str]:
    """The folders of packages that the command line names."""
    folders = [absolute_path(folder) for folder in options.package_path]
    if options.workspace is not None:
        from drake_twin.description.package_index import workspace_folders

        folders += map(str, workspace_folders(options.workspace))
    return folders


def find_launch_file(words: Sequence[str], folders: Sequence[str]) -> Path | None:
    """The launch file that the command line names, as a path or as ``PACKAGE FILE``; None when it names none.

    Raises:
        InputError: there is no such package, or no such launch file in it.
    """
    if len(words) == 2 and _LAUNCH_FILE.match(words[1]) and "/" not in words[0]:
        return _launch_file_of_package(words[0], words[1], folders)
    if len(words) != 1:
        return None
    file = _own_or(words[0])
    is_launch_file = _LAUNCH_FILE.match(file.name) or (file.suffix in (".xml", ".yaml", ".yml") and _is_launch(file))
    return file if is_launch_file else None


def _launch_file_of_package(package: str, name: str, folders: Sequence[str]) -> Path:
    from drake_twin.description.package_index import PackageIndex

    share = PackageIndex(folders).find(package, Path.cwd() / "here")
    found = sorted(path for path in share.rglob("*") if path.is_file() and _LAUNCH_FILE.match(path.name))
    found = [path for path in found if path.suffix != ".py" or "launch" in path.name or path.parent.name == "launch"]
    for path in found:
        if path.name == name:
            return path
    names = dict.fromkeys(path.name for path in found)
    raise InputError(f"package {package!r} has no launch file {name!r}", value=name, valid=names)


def _is_launch(file: Path) -> bool:
    """Whether an XML or YAML file without ``launch`` in its name is a launch file all the same."""
    try:
        with file.open(encoding="utf-8", errors="replace") as stream:
            text = stream.read(4000)
    except OSError:
        return False
    return re.search(r"^\s*<launch\b|^launch\s*:", text, re.MULTILINE) is not None


def _launched(file: Path, options: argparse.Namespace, arguments: Mapping[str, str]) -> Target:
    from drake_twin.builder.launch_file import launch_file_scenario

    if options.robots is not None or options.robot is not None:
        raise InputError(f"{file.name} says itself which robots there are: --robots and --robot do not go with it")
    launched = launch_file_scenario(file, arguments, package_paths(options), time_step=options.time_step)
    return Target(
        launched.scenario,
        launched_commands=launched.scenario.commands,
        paused=launched.paused,
        only_displayed=launched.only_displayed,
        log=launched.log,
    )


def _demo(options: argparse.Namespace, xacro_args: dict[str, str], *, drive: bool) -> Scenario:
    from drake_twin.builder.demo import DEMOS, demo_scenario

    robot = options.robot or "rover"
    if robot not in DEMOS:
        raise InputError(f"--robot {robot}: the twin has no such robot of its own", value=robot, valid=DEMOS)
    if xacro_args:
        raise InputError(f"{_as_typed(xacro_args)}: xacro arguments need a robot file to go to")
    scenario = demo_scenario(robot, options.robots or 2, drive=drive)
    return replace(scenario, package_paths=tuple(package_paths(options)))


def _own_or(name: str) -> Path:
    """A file that the user names; ``diagrams/…`` is the twin's own where there is no such file."""
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
            f"{name} says itself which robots there are: --robots, --robot, --package-path, --workspace and name:=value"
            " do not go with it"
        )
    return ScenarioFile.read(_own_or(name))


def _robot_file(name: str, options: argparse.Namespace, xacro_args: dict[str, str]) -> Scenario:
    from drake_twin.builder.robot_file import robot_file_scenario
    from drake_twin.description.package_index import PackageIndex

    if options.robot is not None:
        raise InputError(f"--robot {options.robot} names a robot of the twin's own: leave it out to run {name}")
    file = PackageIndex(package_paths(options)).resolve(name)
    if file.is_dir():
        raise InputError("a robot file is needed, and this is a folder", file=file)
    return robot_file_scenario(
        file,
        options.robots,
        xacro_args=xacro_args,
        package_paths=package_paths(options),
    )


def _in_world(scenario: Scenario, address: str, *, own_step: bool) -> Scenario:
    """The scenario in the world of a file, at the file's own step where nothing else says one."""
    from drake_twin.description.package_index import PackageIndex
    from drake_twin.description.world_file import read_world

    file = address if "://" in address else absolute_path(address)
    step = read_world(file, PackageIndex(scenario.package_paths)).max_step_size if own_step else None
    if step is not None and SHORTEST_STEP <= step <= LONGEST_STEP:
        scenario = replace(scenario, time_step=step)
    return replace(scenario, world=replace(scenario.world, file=file))


def _command(topic: str, text: str) -> Command:
    """``--pub TOPIC DATA``: DATA as ``ros2 topic pub`` takes it, or the bare list of numbers."""
    import yaml

    try:
        value = load_yaml(text)
        data = value["data"] if isinstance(value, dict) and [*value] == ["data"] else value
        if isinstance(data, dict):
            return Command(topic, data)
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
