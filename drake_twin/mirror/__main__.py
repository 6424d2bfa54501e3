"""``python -m drake_twin.mirror``: the twin of a running robot."""

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from drake_twin.cli.build_line import build_line
from drake_twin.cli.options import parser as run_parser
from drake_twin.errors import InputError
from drake_twin.program import (
    ArgumentParser,
    add_repeated,
    add_version,
    leave,
    run_program,
    say,
    stop_signals,
    write_each,
)

if TYPE_CHECKING:
    from drake_twin.cli.target import Target
    from drake_twin.mirror.heard import Heard
    from drake_twin.mirror.learner import Learner
    from drake_twin.mirror.mirror import Mirror
    from drake_twin.mirror.profile import Profile
    from drake_twin.mirror.traces import Traces

ALARMED = 3  # the exit code after an alarm

_DESCRIPTION = """\
Lets a twin follow a running robot, or a bag of it, from the robot's own files: compares what the robot measures with
what the twin has, and says what is wrong with the robot. It only listens. TARGET, and all other options, are those of
drake_twin.run. The exit code is 0 without an alarm, and 3 with one."""

_EXAMPLES = """\
examples:
  python -m drake_twin.mirror --robots 1 --bag healthy --learn healthy.json
  python -m drake_twin.mirror --robots 1 --bag today --profile healthy.json --report today.html
  python -m drake_twin.mirror arm.urdf.xacro --ros --profile healthy.json"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program; see `drake_twin.program.run_program`."""
    return run_program(_program, arguments)


def _parser() -> argparse.ArgumentParser:
    parser = ArgumentParser(
        prog="python -m drake_twin.mirror",
        description=_DESCRIPTION,
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
        usage="python -m drake_twin.mirror [TARGET] [--bag FOLDER | --ros [NAME]] [options]",
    )
    add_version(parser)
    what = parser.add_argument_group("the robot")
    what.add_argument("--bag", type=Path, metavar="FOLDER", help="a rosbag2 bag of the robot (MCAP, SQLite3)")
    add_repeated(what, "--map", "ROBOT=TWIN", "a topic of the robot and the twin's topic that it stands for")
    what.add_argument("--duration", type=float, metavar="S", help="stop after this time of a running robot")
    how = parser.add_argument_group("what is healthy")
    how.add_argument("--profile", type=Path, metavar="FILE", help="what was learned of the healthy robot (.json)")
    how.add_argument("--learn", type=Path, metavar="FILE", help="learn it from this run, which has no fault (.json)")
    how.add_argument(
        "--false-alarm-every",
        type=float,
        default=1.0,
        metavar="HOURS",
        help="the mean time to a false alarm of noise (default: 1)",
    )
    learned = parser.add_argument_group("values of the twin")
    add_repeated(learned, "--fit", "PATH=LOW:HIGH", "find a value from the last 20 s, as drake_twin.calibrate")
    learned.add_argument("--patch", type=Path, metavar="FILE", help="offer what is found as a scenario (.yaml)")
    out = parser.add_argument_group("output")
    out.add_argument("--report", type=Path, metavar="FILE", help="write a report (.html)")
    parser.add_argument("--debug", action="store_true", help="show the traceback of an error")
    return parser


def _program(arguments: Sequence[str]) -> int:
    options, others = _parser().parse_known_args(arguments)
    target = run_parser().parse_args(others)
    _check(options, target)
    with stop_signals() as stopped:
        return _mirror(options, target, stopped)


def _check(options: argparse.Namespace, target: argparse.Namespace) -> None:
    """Check the options before anything is imported.

    Raises:
        InputError: If one is missing, or its value is out of bounds.
    """
    if (options.bag is None) == (target.ros is None):
        raise InputError("what is to be followed? --bag FOLDER names a bag of the robot, --ros the running one")
    if options.bag is not None and options.duration is not None:
        raise InputError("--duration is for a running robot: a bag has its own")
    if not 0 < options.false_alarm_every <= 1e6:
        raise InputError(f"--false-alarm-every {options.false_alarm_every:g}: it must be above 0 and at most 1e6 hours")
    if options.learn is not None and options.profile is not None:
        raise InputError("--learn writes a profile and --profile reads one: give one of them")
    if bool(options.fit) != (options.patch is not None):
        raise InputError("--fit says what is to be found, and --patch where it is offered: give both")
    for name, suffix in (("report", ".html"), ("learn", ".json"), ("patch", ".yaml")):
        file = getattr(options, name)
        if file is not None and file.suffix != suffix:
            raise InputError(f"--{name} {file}: it must end in {suffix}")
        if file is not None and not file.absolute().parent.is_dir():
            raise InputError(f"--{name} {file}: the folder does not exist")


class _Compared(NamedTuple):
    """What a robot is compared with."""

    renamed: Mapping[str, str]
    profile: "Profile | None"
    traces: "Traces"
    learner: "Learner | None"

    def arguments(self, options: argparse.Namespace) -> dict[str, Any]:
        """Return the arguments of a `Mirror`."""
        return {
            "profile": self.profile,
            "judged": self.traces.add,
            "time_to_false_alarm": 3600.0 * options.false_alarm_every,
            "learns": options.learn is not None,
        }


def _mirror(options: argparse.Namespace, run: argparse.Namespace, stopped: Sequence[int]) -> int:
    renamed = dict(map(_renamed, options.map))
    with build_line(stopped):
        from drake_twin.cli.lost import check_lost
        from drake_twin.cli.target import find_target
        from drake_twin.mirror.profile import Profile
        from drake_twin.mirror.traces import Traces

        if options.fit:
            from drake_twin.calibration.fitted import Fitted

            for text in options.fit:
                Fitted.parse(text)
        profile = None if options.profile is None else Profile.read(options.profile)
        target = find_target(run)
        check_lost(target.scenario.findings, keep_going=run.keep_going)
    learner = None
    if options.fit:
        from drake_twin.mirror.learner import Learner

        learner = Learner(target.scenario, options.fit, options.patch, options.map)
    compared = _Compared(renamed, profile, Traces(), learner)
    if options.bag is not None:
        mirror = _of_bag(options, target, compared, stopped)
    else:
        mirror = _of_robot(options, run, target, compared, stopped)
    try:
        return _finish(options, mirror, compared.traces)
    finally:
        mirror.close()


def _of_bag(options: argparse.Namespace, target: "Target", compared: _Compared, stopped: Sequence[int]) -> "Mirror":
    """Follow a bag, and return the mirror."""
    from drake_twin.mirror.heard import messages_of
    from drake_twin.mirror.mirror import Mirror, follow
    from drake_twin.playback.bag import Bag

    with Bag(options.bag) as bag:
        known = {name: kind for name, (kind, count) in bag.topics.items() if count}
        source = f"the bag {options.bag}"
        mirror = Mirror(target.scenario, known, compared.renamed, source=source, **compared.arguments(options))
        try:
            follow(mirror, _until(stopped, messages_of(bag, mirror.topics.topics), compared.learner))
        except InputError as error:
            if mirror.twin.time == 0:
                mirror.close()
                raise
            mirror.note(f"{error}: what comes before was looked at")  # the bag is damaged
        except BaseException:
            mirror.close()
            raise
        if stopped:
            mirror.note(f"stopped at {mirror.twin.time:.1f} s of the bag's {bag.duration:.1f} s")
        else:
            mirror.proceed(bag.duration)
    if compared.learner is not None and not stopped:
        compared.learner.begin(mirror.topics.topics)
        say(compared.learner.outcome(wait=True) or "")
    return mirror


def _until(stopped: Sequence[int], messages: "Iterator[Heard]", learner: "Learner | None") -> "Iterator[Heard]":
    """Yield messages, which a learner keeps, until a signal arrives."""
    for message in messages:
        if stopped:
            return
        if learner is not None:
            learner.hear(message)
        yield message


def _of_robot(
    options: argparse.Namespace,
    run: argparse.Namespace,
    target: "Target",
    compared: "_Compared",
    stopped: Sequence[int],
) -> "Mirror":
    """Follow a running robot, and return the mirror."""
    from drake_twin.mirror.live import Live
    from drake_twin.mirror.mirror import Mirror
    from drake_twin.wires.registry import wire_kinds
    from drake_twin.wires.wire import Wire, close_all

    wanted = [kind for kind in wire_kinds() if kind.is_wanted(run)]
    for kind in wanted:
        kind.check(run)
    mirror = Mirror(target.scenario, None, compared.renamed, **compared.arguments(options))
    wires: list[Wire] = []
    page: dict[str, Callable[[], None]] = {}
    try:
        if not run.headless:
            from drake_twin.cli.program_page import ProgramPage
            from drake_twin.mirror.page import show_on_page

            show_on_page(mirror)
            page["each_frame"] = ProgramPage(run).show(mirror.twin, target)
        wires.extend(kind.open(run, lambda _: None, is_first=True) for kind in wanted)
        live = Live(mirror, wires, compared.learner)
    except BaseException:
        close_all(wires)
        mirror.close()
        raise
    try:
        live.run(stopped, options.duration, **page)
    finally:
        live.close()
    return mirror


def _renamed(text: str) -> tuple[str, str]:
    robot, _, twin = (part.strip() for part in text.partition("="))
    if not robot or not twin:
        raise InputError(f"--map {text}: it must read ROBOT_TOPIC=TWIN_TOPIC")
    return robot, twin


def _finish(options: argparse.Namespace, mirror: "Mirror", traces: "Traces") -> int:
    from drake_twin.mirror.report import alarm_line, write_report

    for note in mirror.notes:
        say(f"note: {note}", sys.stderr)
    say(mirror.summary())
    for alarm in mirror.alarms:
        say(f"alarm: {alarm_line(alarm)}")
    writers: list[Callable[[], None]] = []
    if options.learn is not None:
        profile = mirror.learned()
        writers.append(partial(_written, profile.save, options.learn))
    if options.report is not None:
        title = f"{options.bag.name if options.bag is not None else 'robot'}: mirror"
        writers.append(partial(_written, partial(_report, write_report, mirror, traces, title), options.report))
    if (failure := write_each(writers)) is not None:
        raise failure
    return ALARMED if mirror.alarms else 0


def _report(write: Callable[..., None], mirror: "Mirror", traces: "Traces", title: str, file: Path) -> None:
    write(file, mirror, traces, title)


def _written(write: Callable[[Path], None], file: Path) -> None:
    write(file)
    say(f"wrote {file}", sys.stderr)


if __name__ == "__main__":
    leave(main())
