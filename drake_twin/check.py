"""``python -m drake_twin.check FILE``: what a robot file contains, what the twin mends in it and what it ignores."""

import argparse
import json
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_twin.cli.build_line import build_line
from drake_twin.cli.lost import check_lost
from drake_twin.cli.plugins import add_plugin, load_plugins
from drake_twin.dataclass import dataclass
from drake_twin.description.package_index import absolute_path
from drake_twin.errors import InputError, TwinError
from drake_twin.findings import Finding, Kind, Weight, counted, texts
from drake_twin.plugin_watch import plugins_watched
from drake_twin.program import (
    ArgumentParser,
    add_keep_going,
    add_strict,
    add_version,
    leave,
    run_program,
    say,
    stop_signals,
)

if TYPE_CHECKING:
    from drake_twin.description.robot_description import RobotDescription
    from drake_twin.twin.twin import Twin

_DESCRIPTION = """\
Reads a robot file (xacro, URDF, SDF or MJCF), builds it, simulates it for 0.1 s, and reports what it contains, what was
mended in it and what the twin ignores. Exit code 0: it runs; 1: it does not run, or --strict does not accept it;
2: the arguments cannot be used, or a model that it includes is lost. Made for the CI of a package."""

_STEPS = 100
_FRAME = 1 / 30  # s
_TOUCHES = {
    "faces": "touches with its faces",
    "wheel": "rolls as an ellipsoid in place of a cylinder",
    "point": "touches in a point",
}


@dataclass(frozen=True)
class Report:
    """The result of a check.

    Attributes:
        file: The robot file.
        ok: Whether the robot loads and can be simulated.
        error: Why it cannot.
        robot: Name, counts, mass, actuators, interfaces, meshes; empty if the file cannot be loaded.
        findings: What of the file is mended, ignored or not started, and warnings.
    """

    file: str
    ok: bool
    error: str | None
    robot: dict[str, Any]
    findings: tuple[Finding, ...]

    @property
    def as_plain(self) -> dict[str, Any]:
        """The report as plain data, for JSON."""
        return {**vars(self), "findings": [finding.as_plain() for finding in self.findings]}


def check(file: str, xacro_args: dict[str, str], package_paths: Sequence[str] = ()) -> Report:
    """Check a robot file; errors of the file are in the report, not raised.

    Args:
        file: The robot file, as a path or an address ``package://``.
        xacro_args: Its xacro arguments.
        package_paths: Folders of ROS packages to search first.

    Raises:
        InputError: If a package folder does not exist.
    """
    from drake_twin.builder.robot_file import planned_robots
    from drake_twin.description.package_index import PackageIndex
    from drake_twin.twin.twin import Twin

    packages = PackageIndex(package_paths)
    try:
        resolved = packages.resolve(file)
        twin = Twin(planned_robots(resolved, xacro_args=xacro_args, package_paths=package_paths).scenario)
        twin.step(_STEPS)
    except TwinError as error:
        return Report(file, ok=False, error=str(error), robot={}, findings=())
    failed = texts(twin.findings, Kind.FAILED)
    return Report(
        file=str(resolved),
        ok=not failed,
        error="; ".join(failed) or None,
        robot=_describe(twin),
        findings=twin.findings,
    )


def _describe(twin: "Twin") -> dict[str, Any]:
    (plan,) = twin.built.plans
    description, plant = plan.description, twin.plant
    instance = plant.GetModelInstanceByName(plan.name)
    context = plant.GetMyContextFromRoot(twin.context)
    return {
        "name": description.name,
        "format": plan.model.drake_format,
        "links": len(description.links),
        "joints": Counter(joint.type for joint in description.joints),
        "degrees_of_freedom": plant.num_velocities(instance),
        "fixed_to_the_world": plan.model.is_fixed,
        "mass": plant.CalcTotalMass(context, [instance]),
        "actuators": [joint.name for joint in description.actuated_joints],
        "command_interfaces": _interfaces(description, "command"),
        "state_interfaces": _interfaces(description, "state"),
        "controllers": [controller.name for controller in plan.controllers],
        "sensors": [sensor.as_plain() for sensor in plan.sensors],
        "meshes": {str(mesh): mesh.stat().st_size for mesh in plan.model.meshes},
        "contact": [
            {
                "link": plant.get_body(shape.body).name(),
                "shape": type(shape.shape).__name__,
                "touches": shape.touches,
                "friction": shape.friction,
            }
            for shape in twin.built.shapes
            if shape.model == plan.name
        ],
    }


def _interfaces(description: "RobotDescription", kind: str) -> dict[str, list[str]]:
    """Return the ``command`` or ``state`` interfaces of each joint and GPIO that has some."""
    joints, gpios = description.controlled_joints, description.gpios
    found = {name: [item.name for item in getattr(joint, f"{kind}_interfaces")] for name, joint in joints.items()}
    found |= {name: [*getattr(gpio, f"{kind}s")] for name, gpio in gpios.items()}
    return {name: names for name, names in found.items() if names}


def _lines(report: Report) -> Iterator[str]:
    """Yield the report's lines, for a person."""
    yield report.file
    if report.error is not None:
        yield f"  error: {report.error}"
    if report.robot:
        yield from _robot_lines(report.robot)
    for finding in sorted(report.findings, key=lambda finding: list(Kind).index(finding.kind)):
        yield f"  {finding.kind}: {finding.sentence}"
    is_mended = any(finding.kind is Kind.MENDED for finding in report.findings)
    is_lost = any(finding.weight is Weight.LOST for finding in report.findings)
    how = "without what is lost" if is_lost else "mended" if is_mended else ""
    verdict = "does not run" if not report.ok else f"runs, {how}" if how else "runs as it is"
    yield f"  verdict: {verdict}"


def _robot_lines(robot: dict[str, Any]) -> Iterator[str]:
    joints = ", ".join(f"{count} {kind}" for kind, count in robot["joints"].items()) or "none"
    base = "fixed to the world" if robot["fixed_to_the_world"] else "free"
    yield f"  robot: {robot['name']} ({robot['format']}), {base}"
    yield f"  links: {robot['links']}; joints: {joints}; degrees of freedom: {robot['degrees_of_freedom']}"
    yield f"  mass: {robot['mass']:.4g} kg"
    yield f"  actuators: {', '.join(robot['actuators']) or 'none'}"
    for kind in ("command_interfaces", "state_interfaces"):
        by_names: dict[str, list[str]] = {}
        for joint, names in robot[kind].items():
            by_names.setdefault(", ".join(names), []).append(joint)
        for names, of_joints in by_names.items():
            yield f"  {kind.replace('_', ' ')}: {names}: {', '.join(of_joints)}"
    yield f"  active controllers: {', '.join(robot['controllers']) or 'none'}"
    yield from map(_sensor_line, robot["sensors"])
    for touches, meaning in _TOUCHES.items():
        links = Counter(item["link"] for item in robot["contact"] if item["touches"] == touches)
        if links:
            names = ", ".join(link if count == 1 else f"{link} ({count})" for link, count in links.items())
            yield f"  {meaning}: {names}"
    total = sum(robot["meshes"].values())
    if robot["meshes"]:
        yield f"  meshes: {len(robot['meshes'])} files, {total / 1e6:.2f} MB"
    for mesh, size in robot["meshes"].items():
        yield f"    {size / 1e3:9.1f} kB  {mesh}"


def _sensor_line(sensor: dict[str, Any]) -> str:
    topics = ", ".join(f"{topic} ({kind})" for topic, kind in sensor["topics"].items()) or "no topic"
    rate = f"{sensor['rate']:g} Hz" if sensor["rate"] else "every step"
    noise = "; ".join(f"{channel}: {text}" for channel, text in sensor["noise"].items()) or "none"
    frame = f"frame {sensor['frame']}" if sensor["frame"] else "no frame"
    return f"  sensor {sensor['name']} ({sensor['kind']}) on {sensor['on']}: {topics}, {frame}, {rate}, noise: {noise}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program; see `drake_twin.program.run_program`."""
    return run_program(_program, arguments)


def _parser() -> ArgumentParser:
    parser = ArgumentParser(
        prog="python -m drake_twin.check",
        description=_DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", metavar="FILE", help="the robot file")
    parser.add_argument("xacro_args", nargs="*", metavar="name:=value", help="xacro arguments")
    parser.add_argument("--package-path", action="append", default=[], metavar="DIR", help="a folder of ROS packages")
    parser.add_argument("--json", action="store_true", help="print the report as JSON")
    add_strict(parser, "exit code 1 also")
    add_keep_going(parser)
    parser.add_argument("--view", action="store_true", help="show the robot on the page, with a slider for each joint")
    parser.add_argument("--no-browser", action="store_true", help="do not open the page in a browser")
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")
    add_version(parser)
    add_plugin(parser)
    return parser


def _program(arguments: Sequence[str]) -> int:
    options = _parser().parse_args(arguments)
    with plugins_watched(options.plugin):
        load_plugins(options.plugin)
        return _check(options)


def _check(options: argparse.Namespace) -> int:
    """Check a file, and print what was found."""
    for argument in options.xacro_args:
        if ":=" not in argument:
            raise InputError(f"{argument!r} is neither the robot file nor a xacro argument name:=value")
    xacro_args = dict(argument.split(":=", 1) for argument in options.xacro_args)
    paths = [absolute_path(folder) for folder in options.package_path]
    with stop_signals() as stopped:
        with build_line(stopped):
            report = check(options.file, xacro_args, paths)
        say(json.dumps(report.as_plain, indent=2) if options.json else "\n".join(_lines(report)))
        if options.view and report.ok:
            _view(Path(report.file), xacro_args, paths, stopped, open_browser=not options.no_browser)
    if not report.ok or counted(report.findings, options.strict):
        return 1
    check_lost(report.findings, keep_going=options.keep_going)
    return 0


def _view(
    file: Path,
    xacro_args: Mapping[str, str],
    package_paths: Sequence[str],
    stopped: Sequence[int],
    *,
    open_browser: bool,
) -> None:
    """Show a robot file with a slider for each joint, without physics, until a signal arrives."""
    from drake_twin.builder.robot_file import planned_robots
    from drake_twin.cockpit.served_page import ServedPage
    from drake_twin.twin.twin import Twin

    with build_line(stopped):
        page = ServedPage()
        twin = Twin(planned_robots(file, xacro_args=xacro_args, package_paths=package_paths).scenario)
        cockpit = page.show(twin, only_displayed=True)
    page.announce(open_browser=open_browser)
    while not stopped:
        cockpit.process_requests()
        time.sleep(_FRAME)
    page.close()


if __name__ == "__main__":
    leave(main())
