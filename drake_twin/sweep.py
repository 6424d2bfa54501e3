"""``python -m drake_twin.sweep``: a scenario over values and seeds, on all cores, as a table."""

import argparse
import os
import shlex
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_twin.cli.build_line import build_line
from drake_twin.errors import InputError, RunError
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
from drake_twin.python_process import own_cores
from drake_twin.sweeps.processes import Processes

if TYPE_CHECKING:
    from drake_twin.sweeps.dispatch import Dispatcher
    from drake_twin.sweeps.episode import Sweep
    from drake_twin.sweeps.results import Results

_DESCRIPTION = """\
Runs a scenario many times, with varied values and seeds, in a process for each core, and writes a table with one row
for each run. A sweep that was stopped or killed continues with the same command. TARGET is what drake_twin.run runs."""

_EXAMPLES = """\
examples:
  python -m drake_twin.sweep two_rovers.yaml --vary friction=0.3:1.0:8 --vary robot_1.payload=0,1,2 --seeds 20 \\
      --duration 5 --metric distance --out results.parquet
  python -m drake_twin.sweep two_rovers.yaml --vary "friction=uniform(0.2,1)" --samples 64 --out results.csv
  python -m drake_twin.sweep --show results.parquet --plot sweep.png
  python -m drake_twin.run --episode results.parquet:17"""

_ENGINES = ("processes", "ray")
_MANY = 100_000  # episodes that need --yes
_MOST = 1_000_000  # samples, seeds, processes


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program; see `drake_twin.program.run_program`."""
    return run_program(_program, arguments)


def _parser() -> ArgumentParser:
    parser = ArgumentParser(
        prog="python -m drake_twin.sweep",
        description=_DESCRIPTION,
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,  # the command that continues is made from these words
    )
    parser.add_argument(
        "target", nargs="*", metavar="TARGET [name:=value …]", help="what to run, as for drake_twin.run"
    )
    add_version(parser)
    what = parser.add_argument_group("what is run")
    taken = "a,b,c or FIRST:LAST:COUNT, or uniform(a,b), normal(m,s), loguniform(a,b)"
    add_repeated(what, "--vary", "PATH=VALUES", f"a value and what it takes: {taken}", ": all combinations")
    add_repeated(
        what,
        "--push",
        "ROBOT[.LINK]=FORCE@TIME",
        "push a link, for example robot_1=20N@1s: 20 N for 0.1 s from 1 s on, horizontally in a direction that is drawn"
        " from the seed; or robot_1.base_link=20,0,5N@1s+0.2s",
    )
    what.add_argument(
        "--retune", action="store_true", help="let servo gains follow the varied robot, not the file's (needs builds)"
    )
    what.add_argument("--samples", type=int, default=16, metavar="N", help="samples of the distributions (default: 16)")
    what.add_argument("--seeds", type=int, default=1, metavar="N", help="run each with the seeds 0 to N-1 (default: 1)")
    what.add_argument("--duration", type=float, default=5.0, metavar="S", help="simulated seconds (default: 5)")
    metrics = "distance, tracking_error, energy, max_effort, slip, settled, or NAME=FILE.py:FUNCTION"
    add_repeated(what, "--metric", "NAME", metrics)
    what.add_argument("--until", metavar="CONDITION", help="end early: fell, settled, or FILE.py:FUNCTION")
    how = parser.add_argument_group("how it is run")
    how.add_argument("--out", type=Path, metavar="FILE", help="the table: .parquet, .csv or .jsonl")
    how.add_argument("--workers", type=int, metavar="N", help="processes (default: one for each core)")
    how.add_argument(
        "--engine", default="processes", metavar="NAME", help="processes (default), or ray, which opens ports"
    )
    how.add_argument(
        "--address", metavar="HOST:PORT", help="run in this cluster of Ray (default: one of this machine alone)"
    )
    how.add_argument("--timeout", type=float, default=600.0, metavar="S", help="longest wall time (default: 600)")
    how.add_argument("--force", action="store_true", help="run all again, also where the file is of another sweep")
    add_keep_going(how)
    how.add_argument("--yes", action="store_true", help=f"run more than {_MANY:,} episodes")
    shown = parser.add_argument_group("what is shown")
    shown.add_argument("--show", type=Path, metavar="FILE", help="print what a table says, and end")
    shown.add_argument("--plot", type=Path, metavar="FILE", help="draw the metrics over the values (.png, .svg, .pdf)")
    shown.add_argument(
        "--pairs", type=Path, metavar="FILE", help="draw each two values against each other, colored by the metrics"
    )
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")
    return parser


def _program(arguments: Sequence[str]) -> int:
    options = _parser().parse_args(arguments)
    for name in ("plot", "pairs"):
        check_figure(f"--{name}", getattr(options, name))
    if options.show is not None:
        _show(options.show, options)
        return 0
    _check(options)
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):  # a process for each core is enough
        os.environ.setdefault(name, "1")
    cores = own_cores()
    ahead = min(options.workers or cores, cores) if options.engine == "processes" else 0
    with stop_signals() as stopped, Processes(ahead) as processes:
        return _sweep(options, arguments, stopped, processes)


def _check(options: argparse.Namespace) -> None:
    """Check the options before anything is imported.

    Raises:
        InputError: If one is missing, or its value is out of bounds.
    """
    if options.out is None:
        raise InputError("--out FILE is missing: the table that the sweep writes (.parquet, .csv or .jsonl)")
    if options.engine not in _ENGINES:
        raise InputError(f"--engine {options.engine}: unknown engine", value=options.engine, valid=_ENGINES)
    if options.address is not None and options.engine != "ray":
        raise InputError("--address names a cluster of Ray: it needs --engine ray")
    for name in ("samples", "seeds", "workers"):
        value = getattr(options, name)
        if value is not None and not 1 <= value <= _MOST:
            what = "1 or more" if value < 1 else f"{_MOST:,} at most"
            raise InputError(f"--{name} {value}: it must be {what}")
    for name in ("duration", "timeout"):
        value = getattr(options, name)
        if not 0 < value <= 1e9:
            raise InputError(f"--{name} {value:g}: it must be above zero, and 1e9 at most")


def _sweep(options: argparse.Namespace, arguments: Sequence[str], stopped: Sequence[int], processes: Processes) -> int:
    with build_line(stopped):
        from drake_twin.cli.lost import check_lost
        from drake_twin.sweeps.episode import ERROR, trial
        from drake_twin.sweeps.progress_line import ProgressLine
        from drake_twin.sweeps.results import Results, check_format

        check_format(options.out)
        sweep = _described(options)
    if len(sweep) > _MANY and not options.yes:
        raise InputError(f"these are {len(sweep):,} episodes: --yes runs them")
    results = Results(options.out, sweep, force=options.force)
    left = len(sweep) - len(results.rows)
    if not left:
        say(f"{options.out}: all {len(sweep)} episodes are there already (--force runs them again)")
        return _finish(results, options, Counter())
    outcomes: Counter[str] = Counter()
    try:
        with _engine(options, sweep, left, processes) as engine:
            with build_line(stopped):
                check_lost(trial(sweep), keep_going=options.keep_going)
            episodes = (item for item in sweep.design.episodes() if sweep.id_of(item) not in results.rows)
            with ProgressLine(len(sweep), len(results.rows)) as progress:
                for row in engine.rows(episodes, stopped):
                    results.add(row)
                    progress.show(row)
                    outcomes[row["outcome"]] += 1
    except (InputError, KeyboardInterrupt):
        results.discard_empty()
        raise
    except RunError as error:
        raise RunError(f"{error}. To continue: {_command(arguments)}") from None
    if stopped:
        results.close()
        say(f"{len(results.rows)} of {len(sweep)} episodes are in {options.out}. To continue: {_command(arguments)}")
        return 130
    code = _finish(results, options, outcomes)
    return 1 if code == 0 and outcomes[ERROR] == len(sweep) else code


def _engine(options: argparse.Namespace, sweep: "Sweep", left: int, processes: Processes) -> "Dispatcher[Any]":
    """Start the engine that the options name, for as many episodes as are left."""
    from drake_twin.sweeps.engine import Engine

    if options.engine == "ray":
        from drake_twin.sweeps.ray_engine import RayEngine

        cores = left if options.address else own_cores()  # a cluster says itself how many it has
        return RayEngine(sweep, min(options.workers or cores, left), options.timeout, options.address)
    return Engine(sweep, min(options.workers or own_cores(), left), options.timeout, processes)


def _described(options: argparse.Namespace) -> "Sweep":
    """Return the sweep that the options describe.

    Raises:
        InputError: If the target, a value, a metric or a condition cannot be used.
    """
    from drake_twin.cli.options import parser as run_parser
    from drake_twin.cli.target import find_target
    from drake_twin.sweeps.episode import Sweep
    from drake_twin.sweeps.launched import LaunchFile, without_nodes
    from drake_twin.sweeps.metrics import Condition, Metric
    from drake_twin.sweeps.push_option import with_pushes
    from drake_twin.sweeps.variation import Design, Variation

    design = Design(tuple(map(Variation.parse, options.vary)), options.samples, tuple(range(options.seeds)))
    metrics = tuple(map(Metric.parse, options.metric))
    until = None if options.until is None else Condition(options.until)
    if until is not None:
        until.call  # noqa: B018  # raises what is wrong with it
    run_options = run_parser().parse_args(options.target)
    launch = LaunchFile.of(run_options, design.paths)
    if launch is None:
        scenario = without_nodes(find_target(run_options).scenario)
    else:
        scenario = launch.scenario(next(design.episodes()).values)
    scenario = with_pushes(scenario, options.push, options.duration)
    if options.retune:
        scenario = replace(scenario, retune=True)
    return Sweep.of(scenario, design, options.duration, metrics=metrics, until=until, launch=launch)


def _finish(results: "Results", options: argparse.Namespace, outcomes: Counter[str]) -> int:
    results.close()
    if outcomes:
        said = ", ".join(f"{count} {what}" for what, count in outcomes.most_common())
        say(f"{options.out}: {len(results.rows)} rows ({said})")
    _show(options.out, options)
    return 0


def _show(file: Path, options: argparse.Namespace) -> None:
    from drake_twin.sweeps.report import draw, draw_pairs, report
    from drake_twin.sweeps.results import read_table

    definition, rows = read_table(file)
    say(report(definition, rows))

    def write(function: Callable[..., None], figure: Path) -> None:
        function(figure, definition, rows)
        say(f"wrote {figure}", sys.stderr)

    figures = ((draw, options.plot), (draw_pairs, options.pairs))
    failure = write_each(partial(write, function, figure) for function, figure in figures if figure is not None)
    if failure is not None:
        raise failure


def _command(arguments: Sequence[str]) -> str:
    return "python -m drake_twin.sweep " + shlex.join(item for item in arguments if item != "--force")


if __name__ == "__main__":
    leave(main())
