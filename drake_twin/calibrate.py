"""``python -m drake_twin.calibrate``: the values that a robot has, from logs of it."""

import argparse
import os
import shlex
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from drake_twin.cli.build_line import build_line
from drake_twin.errors import InputError
from drake_twin.program import (
    ArgumentParser,
    add_keep_going,
    add_repeated,
    add_version,
    check_figure,
    leave,
    run_program,
    say,
    stop_signals,
    write_each,
)

if TYPE_CHECKING:
    from drake_twin.calibration.result import Result

_DESCRIPTION = """\
Finds the masses, frictions, dampings and other values with which the twin of a robot moves as logs of it say: their
commands are repeated in the twin, and what it would have measured is compared with what was measured. The values are
written only if the twin moves as measured and no others fit as well; if not, the exit code is 1. TARGET is what
drake_twin.run runs."""

_EXAMPLES = """\
examples:
  python -m drake_twin.calibrate robot.yaml --log real_run.mcap --fit friction=0.05:1.2 \\
      --fit robot_1.base_link.mass=5:30 --out fitted.yaml
  python -m drake_twin.calibrate robot.yaml --log run_1 --log run_2 --fit robot_1.claw.payload=0.01:2 \\
      --map /mocap/pose=/robot_1/ground_truth/odom --noise place=0.001 --out fitted.yaml --plot fit.png
  python -m drake_twin.run fitted.yaml"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program; see `drake_twin.program.run_program`."""
    return run_program(_program, arguments)


def _parser() -> ArgumentParser:
    parser = ArgumentParser(
        prog="python -m drake_twin.calibrate",
        description=_DESCRIPTION,
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,  # the command that continues is made from these words
    )
    parser.add_argument("target", nargs="*", metavar="TARGET [name:=value …]", help="the twin, as for drake_twin.run")
    add_version(parser)
    what = parser.add_argument_group("what is fitted")
    add_repeated(
        what, "--fit", "PATH=LOW:HIGH", "a value and where to search it; paths are those of drake_twin.sweep --vary"
    )
    add_repeated(what, "--log", "FILE", "a rosbag2 bag (MCAP, SQLite3), or a twin's recording, .json")
    add_repeated(what, "--map", "LOG=TWIN", "a topic of the logs and the twin's topic that it stands for")
    add_repeated(what, "--without", "NAME", "leave out a topic or a number, such as j1.effort")
    kinds = "position, velocity, effort, place, angle, linear, angular, acceleration"
    noise = f"standard deviation of a number, or of a kind: {kinds}"
    add_repeated(what, "--noise", "NAME=S", noise, "; by default estimated from the logs")
    what.add_argument(
        "--longest-delay", type=float, metavar="S", help="longest delay of a topic to look for (default: 0.1; 0: none)"
    )
    how = parser.add_argument_group("how it is searched")
    how.add_argument(
        "--method",
        default="auto",
        help="auto (default): a screen, least squares, evolution where they fail; least-squares: from the scenario's"
        " values; sobol: the first two; evolution",
    )
    add_repeated(how, "--start", "PATH=VALUE", "where to begin", "; by default at the values of the scenario")
    add_keep_going(how)
    how.add_argument("--episodes", type=int, metavar="N", help="simulate a log so often at most (default: 700)")
    out = parser.add_argument_group("output")
    out.add_argument("--out", type=Path, metavar="FILE", help="write the scenario with the values (.yaml)")
    out.add_argument("--plot", type=Path, metavar="FILE", help="draw measured and simulated (.png, .svg, .pdf)")
    out.add_argument("--force", action="store_true", help="write the values also where they are not to be trusted")
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")
    return parser


def _program(arguments: Sequence[str]) -> int:
    options = _parser().parse_args(arguments)
    _check(options)
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):  # for matrices of this size
        os.environ.setdefault(name, "1")
    with stop_signals() as stopped:
        result = _calibrated(options, arguments, stopped)
    return 130 if result is None else _finish(result, options)


def _check(options: argparse.Namespace) -> None:
    """Check the options before anything is imported.

    Raises:
        InputError: If one is missing, or its value is out of bounds.
    """
    for name in ("fit", "log"):
        if not getattr(options, name):
            raise InputError(f"--{name} is missing (--help lists the options)")
    if options.episodes is not None and options.episodes < 1:
        raise InputError(f"--episodes {options.episodes}: it must be 1 or more")
    if options.longest_delay is not None and not 0 <= options.longest_delay <= 10:
        raise InputError(f"--longest-delay {options.longest_delay:g}: it must be from 0 to 10 s")
    if options.out is not None and options.out.suffix not in (".yaml", ".yml"):
        raise InputError(f"--out {options.out}: it must end in .yaml")
    if options.out is not None and not options.out.absolute().parent.is_dir():
        raise InputError(f"--out {options.out}: the folder does not exist")
    check_figure("--plot", options.plot)


def _calibrated(options: argparse.Namespace, arguments: Sequence[str], stopped: Sequence[int]) -> "Result | None":
    """Return the result; None if it was stopped.

    Raises:
        InputError: If the target, a log or an option cannot be used.
    """
    with build_line(stopped):
        from drake_twin.calibration.fit import LONGEST_DELAY, MOST_EPISODES, StoppedError, calibrate
        from drake_twin.calibration.fitted import Fitted
        from drake_twin.calibration.noise import parse_noise
        from drake_twin.cli.lost import check_lost
        from drake_twin.cli.options import parser as run_parser
        from drake_twin.cli.target import find_target

        fitted = [*map(Fitted.parse, options.fit)]
        renamed = dict(map(_renamed, options.map))
        noise = parse_noise(options.noise)
        start = dict(map(_number, options.start))
        scenario = find_target(run_parser().parse_args(options.target)).scenario
        check_lost(scenario.findings, keep_going=options.keep_going)
    try:
        return calibrate(
            scenario,
            options.log,
            fitted,
            noise=noise,
            renamed=renamed,
            left_out=options.without,
            longest_delay=LONGEST_DELAY if options.longest_delay is None else options.longest_delay,
            start=start,
            method=options.method,
            most_episodes=options.episodes or MOST_EPISODES,
            stopped=stopped,
            tell=True,
        )
    except StoppedError as error:
        best = [word for path, value in error.best.items() for word in ("--start", f"{path}={value:.6g}")]
        command = shlex.join([*_without_start(arguments), *best])
        say(f"{error}. To continue: python -m drake_twin.calibrate {command}")
        return None


def _without_start(arguments: Sequence[str]) -> list[str]:
    """Return a command line without ``--start``."""
    words = [word for word in arguments if not word.startswith("--start=")]
    return [word for index, word in enumerate(words) if "--start" not in words[max(index - 1, 0) : index + 1]]


def _number(text: str) -> tuple[str, float]:
    path, _, value = (part.strip() for part in text.partition("="))
    try:
        return path, float(value)
    except ValueError:
        raise InputError(f"--start {text}: it must read PATH=VALUE") from None


def _renamed(text: str) -> tuple[str, str]:
    log, _, twin = (part.strip() for part in text.partition("="))
    if not log or not twin:
        raise InputError(f"--map {text}: it must read LOG_TOPIC=TWIN_TOPIC")
    return log, twin


def _finish(result: "Result", options: argparse.Namespace) -> int:
    from drake_twin.calibration.report import draw, report, write_fitted

    say(report(result))
    writers: list[Callable[[], None]] = []
    if options.out is not None and (options.force or not result.problems):
        writers.append(partial(_write, write_fitted, options.out, result))
    elif options.out is not None:
        say(f"{options.out} is not written (--force writes it)", sys.stderr)
    if options.plot is not None:
        writers.append(partial(_write, draw, options.plot, result))
    if (failure := write_each(writers)) is not None:
        raise failure
    return 1 if result.problems else 0


def _write(write: "Callable[[Path, Result], None]", file: Path, result: "Result") -> None:
    write(file, result)
    say(f"wrote {file}", sys.stderr)


if __name__ == "__main__":
    leave(main())
