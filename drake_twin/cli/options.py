"""The options of ``drake_twin.run``."""

import argparse
import os
import sys
from pathlib import Path
from typing import Any

from drake_twin.cli.node_options import add_node_option
from drake_twin.cli.plugins import add_plugin
from drake_twin.cli.time_step_option import add_time_step
from drake_twin.errors import InputError
from drake_twin.film.kinds import FILMS, PICTURE, Format, check_film, is_film
from drake_twin.program import ArgumentParser, add_keep_going, add_repeated, add_strict, add_version
from drake_twin.scenario import LONGEST_TIME
from drake_twin.wires.registry import wire_kinds

_DESCRIPTION = """\
Runs any number of robots in one Drake simulation, with a page in the browser that shows and steers them.

TARGET is a ROS 2 launch file (Python, XML or YAML; a path, or PACKAGE FILE), a saved scenario (.yaml), a robot file
(xacro, URDF, SDF or MJCF), or an SDF world with robots in it. Without it, --robots N runs robots of the twin's
own. Ctrl-C ends the run."""

_EXAMPLES = """\
examples:
  python -m drake_twin.run --robots 2
  python -m drake_twin.run --robots 8 --headless --duration 10 --summary out.json
  python -m drake_twin.run --robots 2 --pub /robot_1/forward_velocity_controller/commands "[2, 2, 2, 2]"
  python -m drake_twin.run path/to/main.launch.xml robot_name:=robot_1
  python -m drake_twin.run PACKAGE gazebo.launch.py --workspace path/to/ws
  python -m drake_twin.run diagrams/two_rovers.yaml
  python -m drake_twin.run path/to/robot.urdf.xacro name:=value --robots 3
  python -m drake_twin.run --robots 2 --world path/to/some.world
  python -m drake_twin.run --robots 2 --duration 10 --plot run.png
  python -m drake_twin.run --robots 2 --duration 10 --headless --record film.mp4
  python -m drake_twin.run --robots 2 --duration 10 --headless --bag first
  python -m drake_twin.run --robots 2 --compare first
  python -m drake_twin.run --robots 2 --viewer tcp://127.0.0.1:6000"""


class _Record(argparse.Action):
    """Tells the file of a film from that of a recording, by its name: there may be both."""

    def __call__(self, parser: Any, namespace: Any, values: Any, option_string: Any = None) -> None:
        setattr(namespace, "film" if is_film(values) else "record", values)


def _size(text: str) -> tuple[int, int]:
    width, height = map(int, text.lower().split("x"))
    return width, height


class _Parser(ArgumentParser):
    """Leaves ``--ros-args`` … ``--`` to ROS, as its own programs do."""

    def parse_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse a command line."""
        args = sys.argv[1:] if args is None else args
        of_ros: list[str] = []
        if "--ros-args" in args:
            from drake_twin.ros2.ros_arguments import without_ros_arguments

            args, of_ros = without_ros_arguments(args)
        options = super().parse_args(args, namespace)
        options.ros_args = of_ros
        options.film = getattr(options, "film", None)
        return options


def parser() -> ArgumentParser:
    """Return the parser of the command line."""
    parser = _Parser(
        prog="python -m drake_twin.run",
        description=_DESCRIPTION,
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("target", nargs="*", metavar="TARGET [name:=value …]", help="what to run, see above")
    add_version(parser)
    add_plugin(parser)
    parser.add_argument(
        "--show-kinds", action="store_true", help="print the controllers, sensors, … that there are, and end"
    )
    _add_robots(parser.add_argument_group("robots"))
    _add_time(parser.add_argument_group("time"))
    _add_sensors(parser.add_argument_group("sensors"))
    _add_page(parser.add_argument_group("page"))
    ros = parser.add_argument_group("ROS 2")
    for kind in wire_kinds():
        kind.add_options(ros)
    add_node_option(ros)
    _add_launch_files(parser.add_argument_group("launch files"))
    _add_state(parser.add_argument_group("state"))
    _add_output(parser.add_argument_group("output"))
    return parser


def _add_robots(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--robots", type=int, metavar="N", help="how many robots (default: 2 of the twin's own)")
    group.add_argument("--robot", metavar="NAME", help="which of the twin's own robots: rover (default) or arduinobot")
    add_repeated(group, "--package-path", "DIR", "a folder of ROS packages to look in first")
    add_repeated(group, "--workspace", "DIR", "a colcon workspace to look for packages in first, over those after it")
    group.add_argument(
        "--pub",
        nargs=2,
        action="append",
        default=[],
        metavar=("TOPIC", "DATA"),
        help='publish a command at the start, for example "[2, 2, 2, 2]" (may be repeated; replaces the demo drive)',
    )
    group.add_argument(
        "--world",
        metavar="FILE",
        help="the world around them: an SDF file (.world, .sdf), or a built-in one such as empty.sdf",
    )


def _add_time(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--duration", type=float, metavar="S", help="end after so many simulated seconds")
    add_time_step(group)
    group.add_argument(
        "--engine",
        metavar="NAME",
        help="discrete (default), or cenic: error control instead of fixed steps, much faster",
    )
    group.add_argument("--accuracy", type=float, metavar="A", help="the accuracy of cenic (default: 0.001)")
    group.add_argument(
        "--clock-rate", type=float, metavar="HZ", help="the rate of /clock (default: each physics step, as in Gazebo)"
    )
    group.add_argument(
        "--islands",
        type=int,
        metavar="N",
        help="how many robots share a plant where they are far from others, and what rests costs nothing"
        " (default: 8 beside more than eight robots; 0: one plant for all)",
    )
    group.add_argument("--threads", type=int, metavar="N", help="how many threads step islands (default: each core)")
    group.add_argument(
        "--real-time-rate",
        type=float,
        metavar="R",
        help="simulated seconds per second (default: 1 with a page, as fast as possible without)",
    )


def _add_sensors(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--seed", type=int, metavar="N", help="what the noise of sensors is drawn from (default: 0)")
    group.add_argument("--no-sensor-noise", action="store_true", help="let sensors measure without noise")
    group.add_argument("--view-sensors", action="store_true", help="show what all sensors measure on the page")


def _add_page(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--headless", action="store_true", help="no page")
    group.add_argument("--port", type=int, help="the page's port (default: the first free one from 7000 on)")
    group.add_argument("--host", default="127.0.0.1", help="the address to serve the page on (default: 127.0.0.1)")
    group.add_argument(
        "--compare",
        type=Path,
        metavar="BAG",
        help="lay a bag over the run on the page (under Time): ghosts, curves, differences",
    )
    group.add_argument("--no-browser", action="store_true", help="do not open the page in a browser")
    add_repeated(group, "--panel", "FILE", "a .py file with a panel of your own: sliders, buttons, plots, …")
    group.add_argument(
        "--viewer",
        metavar="URL",
        help="also show the twin on the page of a meshcat-server, which several twins share: its zmq_url, for example"
        " tcp://127.0.0.1:6000",
    )
    group.add_argument(
        "--viewer-name", metavar="NAME", help="the twin's folder there (default: the target's name and the process id)"
    )


def _add_launch_files(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--show-args", action="store_true", help="print the arguments of the launch file and end")
    add_strict(group, "refuse to run")
    add_keep_going(group)
    group.add_argument("--watch", action="store_true", help="restart when a file that the twin is made of changes")


def _add_state(group: argparse._ArgumentGroup) -> None:
    group.add_argument("--save-state", type=Path, metavar="FILE", help="save the state at the end")
    group.add_argument("--load-state", type=Path, metavar="FILE", help="continue from a saved state, with its robots")
    group.add_argument(
        "--record",
        type=Path,
        action=_Record,
        metavar="FILE",
        help="record what is done to the twin, for --replay; with a name that ends in"
        f" {', '.join(FILMS)}: a film of the run ({PICTURE}: a picture of its end)",
    )
    group.add_argument("--record-size", type=_size, metavar="WxH", help="the size of a film (default: 1280x720)")
    group.add_argument("--record-rate", type=float, metavar="HZ", help="its pictures a simulated second (default: 30)")
    group.add_argument("--replay", type=Path, metavar="FILE", help="replay a recorded run, then continue from its end")
    group.add_argument("--episode", metavar="FILE:ROW", help="run an episode of a sweep's table again")
    group.add_argument("--end-with-recording", action="store_true", help="end where the recording of --replay ends")


def _add_output(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--findings", action="store_true", help="print all that became of the files, not only the most telling of it"
    )
    group.add_argument("--topics", action="store_true", help="print the topics and their types at the start")
    group.add_argument("--controllers", action="store_true", help="print each robot's controllers at the start")
    add_repeated(group, "--echo", "TOPIC", "print a topic's messages")
    group.add_argument("--summary", type=Path, metavar="FILE", help="write the result as JSON")
    group.add_argument(
        "--plot", type=Path, metavar="FILE", help="draw joints and real-time factor over time (.png, .svg or .pdf)"
    )
    group.add_argument(
        "--save-html", type=Path, metavar="FILE", help="record the run as one page that plays back offline"
    )
    group.add_argument("--show-scenario", action="store_true", help="print the scenario as YAML and end")
    group.add_argument("--graphviz", type=Path, metavar="FILE", help="draw the diagram (.dot or .svg) and end")
    group.add_argument("--debug", action="store_true", help="show the traceback of an error")


def check(options: argparse.Namespace) -> None:
    """Check the option values before any work is done.

    Raises:
        InputError: If a value is invalid, or two options exclude each other.
    """
    if options.robots is not None and options.robots < 1:
        raise InputError(f"--robots {options.robots}: a twin needs at least one robot")
    for name in ("duration", "time_step", "auto_step_error", "clock_rate", "real_time_rate"):
        value = getattr(options, name)
        if value is not None and not 0 < value <= LONGEST_TIME:
            bounds = f"the value must be above zero, and {LONGEST_TIME:g} at most"
            option = "time-step auto:" if name == "auto_step_error" else f"{name.replace('_', '-')} "
            raise InputError(f"--{option}{value:g}: {bounds}")
    if options.auto_step and (options.load_state or options.replay or options.episode):
        raise InputError("--time-step auto: a saved run has its own step")
    if options.plot is not None:
        from drake_twin.cli.plot import check_plot_file

        check_plot_file(options.plot)
    for name in ("summary", "plot", "save_state", "record", "film", "save_html"):
        file = getattr(options, name)
        if file is not None and not _is_writable(file):
            option = "record" if name == "film" else name.replace("_", "-")
            raise InputError(f"--{option} {file}: no file can be written there")
    _check_film(options)
    _check_viewer(options)
    for kind in wire_kinds():
        kind.check(options)
    if options.save_html is not None and options.watch:
        raise InputError("--save-html records one run: it cannot be combined with --watch")
    if options.compare is not None and options.headless:
        raise InputError("--compare lays a bag over the run on the page: it cannot be combined with --headless")
    if options.end_with_recording and (options.replay is None or options.duration is not None):
        what = "it needs --replay FILE" if options.replay is None else "it cannot be combined with --duration"
        raise InputError(f"--end-with-recording ends the run where its recording ends: {what}")
    if options.port is not None and not 1024 <= options.port <= 65535:
        raise InputError(f"--port {options.port}: the page's port must be from 1024 to 65535")


def film_format(options: argparse.Namespace) -> Format:
    """Return what the film of the options is made of."""
    given = {"size": options.record_size, "rate": options.record_rate}
    return Format(**{name: value for name, value in given.items() if value is not None})


def _check_film(options: argparse.Namespace) -> None:
    if options.film is not None:
        check_film("--record", options.film, film_format(options))
    elif (options.record_size, options.record_rate) != (None, None):
        what = "--record-size" if options.record_size is not None else "--record-rate"
        raise InputError(f"{what} is about a film: it needs --record FILE with a name in {', '.join(FILMS)}")


def _check_viewer(options: argparse.Namespace) -> None:
    if options.viewer is not None:
        from drake_twin.shared_viewer.viewer_address import check_viewer_address

        check_viewer_address(options.viewer)
    if options.viewer_name is not None:
        from drake_twin.shared_viewer.viewer_address import check_viewer_name

        check_viewer_name(options.viewer_name)
        if options.viewer is None:
            raise InputError("--viewer-name names the twin on a shared page: it needs --viewer URL")


def _is_writable(file: Path) -> bool:
    folder = file.absolute().parent
    return folder.is_dir() and not file.is_dir() and os.access(file if file.exists() else folder, os.W_OK)
