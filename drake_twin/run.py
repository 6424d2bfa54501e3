"""``python -m drake_twin.run``: robots in one Drake simulation, with a page in the browser."""

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from drake_twin.cli.announcement import announce
from drake_twin.cli.build_line import build_line
from drake_twin.cli.html_file import html_file
from drake_twin.cli.launch_arguments import launch_arguments
from drake_twin.cli.lost import check_failed, check_lost
from drake_twin.cli.node_options import end_of_launch, start_nodes
from drake_twin.cli.observers import Observers
from drake_twin.cli.options import check, parser
from drake_twin.cli.plugins import load_panels, load_plugins
from drake_twin.cli.program_page import ProgramPage
from drake_twin.cli.rebuilt_twin import rebuilt_twin
from drake_twin.cli.results import save_results
from drake_twin.cli.slow_notice import SlowNotice
from drake_twin.cli.status_line import StatusLine
from drake_twin.cli.target import Target, build_twin, find_target
from drake_twin.cli.watched_files import Stamp, Watch, files_read
from drake_twin.cli.wires import Wires, open_wires
from drake_twin.errors import RunError
from drake_twin.plugin_watch import plugins_watched
from drake_twin.program import NO_MEMORY, collecting_later, leave, run_program, say, stop_signals
from drake_twin.scenario.scenario_file import scenario_to_yaml

if TYPE_CHECKING:
    from drake_twin.sweeps.again import EpisodeAgain
    from drake_twin.twin.twin import Twin


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program; see `drake_twin.program.run_program`."""
    return run_program(_program, arguments)


def _program(arguments: Sequence[str]) -> int:
    options = parser().parse_args(arguments)
    with stop_signals() as stopped:  # from here on, for an interrupted import would stay broken
        return _run(options, stopped)


def _run(options: argparse.Namespace, stopped: Sequence[int]) -> int:
    """Print what the options ask for, or build the twin and run it.

    Args:
        options: The command line.
        stopped: The signals that have arrived.
    """
    check(options)
    with ExitStack() as stack:
        stack.enter_context(plugins_watched([*options.plugin, *options.panel]))
        load_plugins(options.plugin)
        load_panels(options.panel)
        if options.show_kinds:
            from drake_twin.cli.kinds import kinds_text

            say(kinds_text())
            return 0
        if options.show_args:
            say(launch_arguments(options))
            return 0
        return _run_target(options, stopped, stack)


def _run_target(options: argparse.Namespace, stopped: Sequence[int], stack: ExitStack) -> int:
    """Build what is to be run, and run it; what has to be ended goes onto the stack."""
    with files_read() as files, collecting_later(), build_line(stopped):
        again = _episode(options)
        target = find_target(options) if again is None else again.target
        if options.show_scenario:
            _print_scenario(target)
            check_lost(target.scenario.findings, keep_going=options.keep_going)
            return 0
        has_page = not (options.headless or options.graphviz or options.end_with_recording)
        page = ProgramPage(options) if has_page else None  # before the twin, for a port may be taken
        runs = not (options.graphviz or options.end_with_recording)
        graph = stack.enter_context(open_wires(options)) if runs else None
        twin = build_twin(target)
    if options.graphviz is not None:
        _draw_diagram(twin, options.graphviz)
        check_lost(twin.findings, keep_going=options.keep_going)
        return 0
    if options.duration is None:
        options.duration = target.end
    announce(twin, target, options)
    if target.paused and page is not None:
        twin.pause()
    if options.real_time_rate is not None:
        twin.clock.real_time_rate = options.real_time_rate
    if options.record is not None:
        twin.recorder.begin()
    failure = None
    scene = None if page is None else page.scene
    try:
        with Observers(options, stopped) as seen, html_file(twin, scene, options.save_html):
            run = _Run(twin, target, files, (page, graph), seen, options, stopped)
            if not options.end_with_recording:
                run.run()
            if again is not None and run.failure is None and (verdict := again.verdict(run.twin)):
                say(verdict, sys.stderr)
                if page is not None and not stopped:  # it stands still at its end, and can be looked at
                    options.duration = None
                    run.twin.pause()
                    run.run()
            failure = save_results(run.twin, run.simulated, run.wall_time, options, run.failure)
    except RunError:  # of the page or the plot, which are written last
        if failure is not None:
            say(f"error: {failure}", sys.stderr)
        raise
    if failure is not None:
        raise failure
    check_lost(run.twin.findings, keep_going=options.keep_going)
    check_failed(run.twin.findings, keep_going=options.keep_going)
    return 0


def _episode(options: argparse.Namespace) -> "EpisodeAgain | None":
    """Return the episode of ``--episode``, which ends where it ended in the sweep; None without the option."""
    if options.episode is None:
        return None
    from drake_twin.sweeps.again import episode_again

    again = episode_again(options)
    if options.duration is None:
        options.duration = again.simulated
    return again


def _print_scenario(target: Target) -> None:
    # What a launch file publishes without a subscriber is left out when the twin is built.
    scenario = (
        build_twin(target).scenario
        if any(command.optional for command in target.scenario.commands)
        else target.scenario
    )
    say(scenario_to_yaml(scenario), end="")


def _draw_diagram(twin: "Twin", file: Path) -> None:
    from drake_twin.diagram.picture import write_picture

    write_picture(twin.diagram, file)
    say(f"wrote {file}")


class _Run:
    """A twin that runs until its end; with ``--watch``, rebuilt whenever one of its files changes.

    Attributes:
        twin: The twin that runs.
        simulated: The time simulated so far (s).
        wall_time: The duration so far (s).
        failure: The error that ended the run; the twin is in its last good state then.
        is_shut_down: Whether the end of a node has ended it.
    """

    def __init__(
        self,
        twin: "Twin",
        target: Target,
        files: dict[Path, Stamp],
        shown_on: tuple[ProgramPage | None, Wires | None],
        observers: Observers,
        options: argparse.Namespace,
        stopped: Sequence[int],
    ):
        self.twin = twin
        self.simulated = self.wall_time = 0.0
        self.failure: RunError | None = None
        self.is_shut_down = False
        self._target = target
        self._page, self._graph = shown_on
        self._observers = observers
        self._options = options
        self._stopped = stopped
        self._watch = Watch(files) if options.watch else None

    def run(self) -> None:
        """Run the twin, and its successors."""
        while True:
            start, begin = time.perf_counter(), self.twin.clock.simulated
            try:
                self._simulate()
            except RunError as error:
                self.failure = error
            except MemoryError:
                self.failure = RunError(NO_MEMORY)
            self.wall_time += time.perf_counter() - start
            self.simulated += self.twin.clock.simulated - begin
            is_over = self.failure is not None or self._stopped or self.is_shut_down
            if is_over or self._watch is None or not self._watch.has_changed:
                return
            self.twin, self._target, self._watch = rebuilt_twin(self.twin, self._target, self._options, self._watch)

    def _simulate(self) -> None:
        """Run to the end, until a signal arrives or until a file changes."""
        twin, options, status, slow = self.twin, self._options, StatusLine(self.twin), SlowNotice(self.twin)
        process_requests: Callable[[], None] = (
            (lambda: None) if self._page is None else self._page.show(twin, self._target)
        )
        observe = self._observers.observe(twin)
        again = self._target.snapshot is not None or self._target.recording is not None
        nodes = start_nodes(twin, self._stopped, again=again)
        if self._graph is not None:
            self._graph.connect(twin, nodes)

        def each_frame() -> bool:
            process_requests()
            observe()
            status.show()
            slow.look()
            is_shut_down = nodes is not None and nodes.shutdown_reason is not None
            return not (self._stopped or is_shut_down) and (self._watch is None or not self._watch.poll())

        try:
            twin.run(
                None if options.duration is None else twin.time + options.duration,
                each_frame=each_frame,
                as_fast_as_possible=options.real_time_rate is None
                and (self._page, options.viewer) == (None, None)
                and (self._graph is None or not self._graph.has_peers),
            )
        finally:
            status.end()
            if nodes is not None:
                nodes.close()
                self.is_shut_down = end_of_launch(nodes)
        observe()


if __name__ == "__main__":
    leave(main())
