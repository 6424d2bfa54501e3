"""``python -m drake_twin.play BAG``: a bag of ROS 2 on the page."""

import argparse
import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from drake_twin.cli.build_line import build_line
from drake_twin.errors import InputError
from drake_twin.program import ArgumentParser, add_version, leave, run_program, say, stop_signals

if TYPE_CHECKING:
    from drake_twin.playback.bag import Bag

_DESCRIPTION = """\
Shows a rosbag2 bag (MCAP or SQLite3) on the page: the robots of its robot_description topics, moved by its transforms
and joint states, without physics."""

_FRAME = 1 / 30  # s
_AHEAD = 1.0  # s of the bag that place the camera


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program; see `drake_twin.program.run_program`."""
    return run_program(_program, arguments)


def _parser() -> ArgumentParser:
    parser = ArgumentParser(
        prog="python -m drake_twin.play",
        description=_DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("bag", metavar="BAG", type=Path, help="the bag's folder")
    parser.add_argument("--rate", type=float, default=1.0, help="seconds of the bag per second (default: 1)")
    parser.add_argument(
        "--compare", type=Path, metavar="BAG", help="lay another bag over it: ghosts, curves, differences"
    )
    parser.add_argument("--package-path", action="append", default=[], metavar="DIR", help="a folder of ROS packages")
    parser.add_argument("--port", type=int, help="the page's port (default: the first free one from 7000 on)")
    parser.add_argument("--no-browser", action="store_true", help="do not open the page in a browser")
    parser.add_argument("--loop", action="store_true", help="begin again where the bag ends")
    parser.add_argument("--end", action="store_true", help="end the program where the bag ends")
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")
    add_version(parser)
    return parser


def _program(arguments: Sequence[str]) -> int:
    options = _parser().parse_args(arguments)
    if not 0 < options.rate < float("inf"):
        raise InputError(f"--rate {options.rate:g} is not a positive number")
    with stop_signals() as stopped, ExitStack() as stack:
        with build_line(stopped):
            from drake_twin.description.package_index import absolute_path
            from drake_twin.playback.bag import Bag

            bag = stack.enter_context(Bag(options.bag))
        _play(bag, tuple(absolute_path(folder) for folder in options.package_path), options, stopped)
    return 0


def _play(bag: "Bag", package_paths: tuple[str, ...], options: argparse.Namespace, stopped: Sequence[int]) -> None:
    with build_line(stopped):
        from drake_twin.cockpit.served_page import ServedPage
        from drake_twin.findings import grouped
        from drake_twin.playback.bag_player import BagPlayer
        from drake_twin.playback.robots import recorded_scenario
        from drake_twin.twin.twin import Twin

        scenario, robots = recorded_scenario(bag, package_paths)
        twin = Twin(scenario)
        player = BagPlayer(bag, twin, robots)
    player.rate, player.loop = options.rate, options.loop
    for kind, sentence in grouped(player.findings):
        say(f"{kind}: {sentence}", sys.stderr)
    page = ServedPage(options.port)
    try:
        player.advance_to(min(_AHEAD, bag.duration))
        cockpit, unplaced = page.show(twin, player=player), player.unplaced
        player.restart()
        player.advance_to(0.0)
        if options.compare is not None:
            player.comparison.open(options.compare)
        player.paused = False
        _announce(bag, [robot.name for robot in robots])
        for name, link in unplaced:
            say(f"no transform places {link}: {name} does not move from its place", sys.stderr)
        page.announce(open_browser=not options.no_browser)
        last = time.perf_counter()
        while not stopped and not (options.end and player.paused):
            now = time.perf_counter()
            player.proceed(now - last)
            last = now
            cockpit.process_requests()
            time.sleep(_FRAME)
    finally:
        page.close()


def _announce(bag: "Bag", robots: Sequence[str]) -> None:
    """Print what the bag holds, and what of it does not move the robots."""
    from drake_twin.playback.posed_bag import is_shown

    say(f"bag: {bag.duration:.3f} s from {bag.start * 1e-9:.3f} s on; robots: {', '.join(robots)}")
    rest = [
        f"{topic} ({kind}, {count})"
        for topic, (kind, count) in sorted(bag.topics.items())
        if topic not in bag.descriptions and not is_shown(topic, kind)
    ]
    if rest:
        say(f"not in the scene, but under Sensors and ROS: {', '.join(rest)}", sys.stderr)
    for topic in sorted(bag.changed_descriptions):
        say(f"not shown: {topic} changes later: the robot is shown as it is described first", sys.stderr)
    if not any(is_shown(topic, kind) for topic, (kind, _) in bag.topics.items()):
        say("nothing moves: the bag has no joint_states, tf or tf_static", sys.stderr)


if __name__ == "__main__":
    leave(main())
