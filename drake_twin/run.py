"""``python -m drake_twin.run``: robots in one Drake simulation, seen in the browser."""

import argparse
import json
import os
import sys
import time
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from drake_twin.description.package_index import absolute_path
from drake_twin.errors import CommandError, InputError, RunError
from drake_twin.program import ArgumentParser, announce_page, run_program, say, stop_signals
from drake_twin.scenario import (
    LONGEST_STEP,
    LONGEST_TIME,
    SHORTEST_STEP,
    Command,
    Scenario,
    ScenarioError,
    ScenarioFile,
    scenario_to_yaml,
)

_DESCRIPTION = """\
Runs any number of robots in one Drake simulation, with a page in the browser that shows and steers them.

TARGET is a saved scenario (.yaml) or a robot file (xacro, URDF, SDF or MJCF). Without it, --robots N runs robots of the
twin's own. Ctrl-C ends the run."""

_EXAMPLES = """\
examples:
  python -m drake_twin.run --robots 2
  python -m drake_twin.run --robots 8 --headless --duration 10 --summary out.json
  python -m drake_twin.run --robots 2 --pub /robot_1/forward_velocity_controller/commands "[2, 2, 2, 2]"
  python -m drake_twin.run diagrams/two_rovers.yaml
  python -m drake_twin.run path/to/robot.urdf.xacro name:=value --robots 3
  python -m drake_twin.run --robots 2 --world path/to/some.world"""

_STATUS_PERIOD = 0.2  # s


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the program; see `drake_twin.program.run_program`."""
    return run_program(_program, arguments)


def _program(arguments: Sequence[str]) -> int:
    options = _parser().parse_args(arguments)
    with stop_signals() as stopped:  # from here on: interrupting an import would break it
        return _run(options, stopped)


def _parser() -> ArgumentParser:
    parser = ArgumentParser(
        prog="python -m drake_twin.run",
        description=_DESCRIPTION,
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("target", nargs="*", metavar="TARGET [name:=value …]", help="what to run, see above")
    robots = parser.add_argument_group("robots")
    robots.add_argument("--robots", type=int, metavar="N", help="how many robots (default: 2 of the twin's own)")
    robots.add_argument("--robot", metavar="NAME", help="which of the twin's own robots: rover (default) or arduinobot")
    robots.add_argument(
        "--package-path",
        action="append",
        default=[],
        metavar="DIR",
        help="a folder of ROS packages to look in first (may be repeated)",
    )
    robots.add_argument(
        "--pub",
        nargs=2,
        action="append",
        default=[],
        metavar=("TOPIC", "DATA"),
        help='publish a command at the start, for example "[2, 2, 2, 2]" (may be repeated; replaces the demo drive)',
    )
    robots.add_argument(
        "--world",
        metavar="FILE",
        help="the world they stand in: an SDF file (.world, .sdf), or a built-in one such as empty.sdf",
    )
    timing = parser.add_argument_group("time")
    timing.add_argument("--duration", type=float, metavar="S", help="end after so many simulated seconds")
    timing.add_argument("--time-step", type=float, metavar="S", help="physics step (default: 0.001)")
    timing.add_argument(
        "--real-time-rate",
        type=float,
        metavar="R",
        help="simulated seconds a second (default: 1 with a page, as fast as possible without)",
    )
    page = parser.add_argument_group("page")
    page.add_argument("--headless", action="store_true", help="no page")
    page.add_argument("--port", type=int, help="the page's port (default: the first free one from 7000 on)")
    page.add_argument("--host", default="127.0.0.1", help="the address the page is served at (default: 127.0.0.1)")
    page.add_argument("--no-browser", action="store_true", help="do not open the page in a browser")
    output = parser.add_argument_group("output")
    output.add_argument("--summary", type=Path, metavar="FILE", help="write the result as JSON")
    output.add_argument("--show-scenario", action="store_true", help="print the scenario as YAML and end")
    output.add_argument("--graphviz", type=Path, metavar="FILE", help="draw the diagram (.dot or .svg) and end")
    output.add_argument("--debug", action="store_true", help="show the traceback of an error")
    return parser


def _run(options: argparse.Namespace, stopped: Sequence[int]) -> int:
    _check(options)
    scenario, file = _scenario(options)
    if options.show_scenario:
        say(scenario_to_yaml(scenario), end="")
        return 0
    meshcat = None
    if not options.headless and options.graphviz is None:
        from drake_twin.cockpit.page import open_meshcat

        meshcat = open_meshcat(options.port, options.host)
    twin = _twin(scenario, file, meshcat)
    if options.graphviz is not None:
        from drake_twin.diagram.picture import write_picture

        write_picture(twin.diagram, options.graphviz)
        say(f"wrote {options.graphviz}")
        return 0
    for kind, sentences in (("warning", twin.warnings), ("not started", twin.not_started)):
        for sentence in _grouped(sentences, twin.robots):
            say(f"{kind}: {sentence}", sys.stderr)
    wall_time = _simulate(twin, meshcat, options, stopped)
    _report(twin, wall_time, options.summary)
    return 0


def _check(options: argparse.Namespace) -> None:
    """Refuses option values before any work is done."""
    if options.robots is not None and options.robots < 1:
        raise InputError(f"--robots {options.robots}: a twin needs at least one robot")
    for name in ("duration", "time_step", "real_time_rate"):
        value = getattr(options, name)
        if value is not None and not 0 < value <= LONGEST_TIME:
            bounds = f"the value must be above zero, and {LONGEST_TIME:g} at most"
            raise InputError(f"--{name.replace('_', '-')} {value:g}: {bounds}")
    if options.summary is not None:
        folder = options.summary.absolute().parent
        target = options.summary if options.summary.exists() else folder
        if not folder.is_dir() or options.summary.is_dir() or not os.access(target, os.W_OK):
            raise InputError(f"--summary {options.summary}: no file can be written there")
    if options.port is not None and not 1024 <= options.port <= 65535:
        raise InputError(f"--port {options.port}: the page's port is a number from 1024 to 65535")


def _scenario(options: argparse.Namespace) -> tuple[Scenario, ScenarioFile | None]:
    """The scenario that the command line asks for, and its file if it was read from one."""
    xacro_args = dict(item.split(":=", 1) for item in options.target if ":=" in item)
    targets = [item for item in options.target if ":=" not in item]
    if len(targets) > 1:
        raise InputError(f"one scenario or robot file can be run at a time, but there are {', '.join(targets)}")
    commands = tuple(_command(topic, data) for topic, data in options.pub)
    file = None
    if not targets:
        scenario = _demo(options, xacro_args, drive=not commands)
    elif targets[0].endswith((".yaml", ".yml")):
        file = _scenario_file(targets[0], options, xacro_args)
        scenario = file.scenario
    else:
        scenario = _robot_file(targets[0], options, xacro_args)
    if options.world is not None:
        scenario = _in_world(scenario, options.world, own_step=file is None and options.time_step is None)
    if options.time_step is not None:
        scenario = replace(scenario, time_step=options.time_step)
    if commands:
        topics = {command.topic for command in commands}
        kept = tuple(command for command in scenario.commands if command.topic not in topics)
        scenario = replace(scenario, commands=kept + commands)
    return scenario, file


def _demo(options: argparse.Namespace, xacro_args: dict[str, str], *, drive: bool) -> Scenario:
    from drake_twin.launch.demo import DEMOS, demo_scenario

    robot = options.robot or "rover"
    if robot not in DEMOS:
        raise InputError(f"--robot {robot}: the twin has no such robot of its own", value=robot, valid=DEMOS)
    if xacro_args:
        raise InputError(f"{_as_typed(xacro_args)}: xacro arguments need a robot file to go to")
    scenario = demo_scenario(robot, options.robots or 2, drive=drive)
    return replace(scenario, package_paths=tuple(absolute_path(folder) for folder in options.package_path))


def _scenario_file(name: str, options: argparse.Namespace, xacro_args: dict[str, str]) -> ScenarioFile:
    from drake_twin.description.package_index import share_folder

    if xacro_args or options.robots is not None or options.robot is not None or options.package_path:
        raise InputError(
            f"{name} says itself which robots there are: --robots, --robot, --package-path and name:=value do not go"
            " with it"
        )
    file = Path(name)
    if not file.exists() and file.parts[:1] == ("diagrams",):  # the twin's own, from any folder
        file = share_folder("diagrams").joinpath(*file.parts[1:])
    return ScenarioFile.read(file)


def _robot_file(name: str, options: argparse.Namespace, xacro_args: dict[str, str]) -> Scenario:
    from drake_twin.description.package_index import PackageIndex
    from drake_twin.launch.robot_file import robot_file_scenario

    if options.robot is not None:
        raise InputError(f"--robot {options.robot} names a robot of the twin's own: leave it out to run {name}")
    file = PackageIndex(options.package_path).resolve(name)
    if file.is_dir():
        raise InputError("a robot file is needed, and this is a folder", file=file)
    return robot_file_scenario(
        file,
        options.robots,
        xacro_args=xacro_args,
        package_paths=[absolute_path(folder) for folder in options.package_path],
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
        value = yaml.safe_load(text)
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


def _twin(scenario: Scenario, file: ScenarioFile | None, meshcat: Any) -> Any:
    from drake_twin.twin import Twin

    try:
        return Twin(scenario, meshcat)
    except ScenarioError as error:
        if file is None and error.path[0] == "commands":  # typed with --pub: it has no place in a file
            raise CommandError(error.reason, **error.more) from None
        raise (error if file is None else file.located(error)) from None


def _simulate(twin: Any, meshcat: Any, options: argparse.Namespace, stopped: Sequence[int]) -> float:
    """Runs to the end or until stopped; returns the wall time it took (s)."""
    if options.real_time_rate is not None:
        twin.real_time_rate = options.real_time_rate
    status = _StatusLine(twin)
    panel = None if meshcat is None else _show(twin, meshcat, open_browser=not options.no_browser)

    def each_frame() -> bool:
        if panel is not None:
            panel.obey()
        status.show()
        return not stopped

    start = time.perf_counter()
    try:
        twin.run(
            options.duration,
            each_frame=each_frame,
            as_fast_as_possible=meshcat is None and options.real_time_rate is None,
        )
    finally:
        status.end()
    return time.perf_counter() - start


def _show(twin: Any, meshcat: Any, *, open_browser: bool) -> Any:
    """Sets up the page and says where it is; returns its panel."""
    from drake_twin.cockpit.page import set_scene
    from drake_twin.cockpit.panel import Panel

    set_scene(meshcat, twin)
    panel = Panel(meshcat, twin)
    twin.draw()
    announce_page(meshcat.web_url(), open_browser=open_browser)
    return panel


class _StatusLine:
    """Simulation time and real-time factor on one line of the terminal."""

    def __init__(self, twin: Any):
        self._twin = twin
        self._shown = sys.stdout is not None and sys.stdout.isatty()
        self._last = (time.perf_counter(), twin.time)

    def show(self) -> None:
        now, sim_time = time.perf_counter(), self._twin.time
        then, sim_then = self._last
        if not self._shown or now - then < _STATUS_PERIOD:
            return
        factor = max(0.0, sim_time - sim_then) / (now - then)
        state = "paused" if self._twin.paused else f"real-time factor {factor:.2f}"
        say(f"\r\033[Ksim time {sim_time:.2f} s   {state}", end="")
        self._last = (now, sim_time)

    def end(self) -> None:
        if self._shown:
            say("\r\033[K", end="")


def _report(twin: Any, wall_time: float, file: Path | None) -> None:
    from drake_twin.summary import summary

    result = summary(twin, wall_time)
    count = len(result["robots"])
    say(
        f"{count} robot{'s' if count > 1 else ''}, {result['sim_time']:.3f} s simulated in {wall_time:.3f} s"
        f" (real-time factor {result['real_time_factor']:.2f}), state {result['state_sha256'][:12]}"
    )
    if file is not None:
        try:
            file.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
        except OSError as error:
            raise RunError(f"the summary {file} cannot be written ({error.strerror})") from None


def _grouped(sentences: Iterable[str], robots: Sequence[str]) -> list[str]:
    """The same sentence about several robots, once."""
    about: dict[str, list[str]] = {}
    for sentence in sentences:
        robot, separator, rest = sentence.partition(": ")
        if separator and robot in robots:
            names = about.setdefault(rest, [])
            names += [] if robot in names else [robot]
        else:
            about.setdefault(sentence, [])
    return [f"{', '.join(names)}: {text}" if names else text for text, names in about.items()]


def _as_typed(xacro_args: dict[str, str]) -> str:
    return " ".join(f"{name}:={value}" for name, value in xacro_args.items())


if __name__ == "__main__":
    sys.exit(main())
