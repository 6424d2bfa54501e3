"""``python -m drake_twin.run``: robots in one Drake simulation, seen in the browser."""

import signal

if __name__ == "__main__":  # until the program can say goodbye, Ctrl-C ends it without a word
    signal.signal(signal.SIGINT, signal.SIG_DFL)

import argparse
import contextlib
import json
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from drake_twin.cli.options import check, parser
from drake_twin.cli.target import Target, build_twin, find_launch_file, find_target, package_paths, target_name
from drake_twin.cli.watched_files import Watch, files_read
from drake_twin.errors import InputError, RunError, TwinError
from drake_twin.findings import counted, grouped, strict_text
from drake_twin.program import announce_page, collecting_later, leave, run_program, say, stop_signals
from drake_twin.progress import heard
from drake_twin.scenario.scenario_file import scenario_to_yaml
from drake_twin.whole_file import write_whole

_STATUS_PERIOD = 0.2  # s
_PATIENCE = 0.3  # s from a signal on: what is built by then still writes its summary
_END_WAIT, _STOPPED_WAIT = 10.0, 0.5  # s: for a shared page to take a run's last state


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the program; see `drake_twin.program.run_program`."""
    return run_program(_program, arguments)


def _program(arguments: Sequence[str]) -> int:
    options = parser().parse_args(arguments)
    with stop_signals() as stopped:  # from here on: interrupting an import would break it
        return _run(options, stopped)


def _run(options: argparse.Namespace, stopped: Sequence[int]) -> int:
    check(options)
    if options.show_args:
        return _show_arguments(options)
    with files_read() as files, collecting_later(), _build_line(stopped):
        target = find_target(options)
        if options.show_scenario:
            # What a launch file publishes where nobody listens is left out when the twin is built.
            scenario = build_twin(target).scenario if target.launched_commands else target.scenario
            say(scenario_to_yaml(scenario), end="")
            return 0
        page, scene = _open_page(options)
        twin = build_twin(target)
    if options.graphviz is not None:
        from drake_twin.diagram.picture import write_picture

        write_picture(twin.diagram, options.graphviz)
        say(f"wrote {options.graphviz}")
        return 0
    _announce(twin, target, options)
    if target.paused and page is not None:
        twin.pause()
    if options.real_time_rate is not None:
        twin.real_time_rate = options.real_time_rate
    wall_time = 0.0
    watch = Watch(files) if options.watch else None
    if options.record is not None:
        twin.record()
    failure: RunError | None = None
    with _recorded(twin, scene, options.save_html), _Observers(options, stopped) as observers:
        while True:
            start = time.perf_counter()
            try:
                _simulate(twin, target, page, options, stopped, watch, observers)
            except RunError as error:
                failure = error  # the twin is in its last good state
            wall_time += time.perf_counter() - start
            if failure is not None or watch is None or stopped or not watch.is_broken_off:
                break
            twin, target, watch = _again(twin, target, options, watch)
        failure = _save(twin, wall_time, options, failure)
    if failure is not None:
        raise failure
    return 0


@contextlib.contextmanager
def _build_line(stopped: Sequence[int]) -> Iterator[None]:
    """Shows on one line of the terminal what is being built, and ends it when that is to end and takes long.

    Raises:
        KeyboardInterrupt: a signal has arrived, and the twin is not there yet.
    """
    is_shown = sys.stderr is not None and sys.stderr.isatty()
    last, asked = time.perf_counter(), None

    def hear(what: str) -> None:
        nonlocal last, asked
        now = time.perf_counter()
        if stopped and asked is None:
            asked = now
        if asked is not None and now - asked > _PATIENCE:
            raise KeyboardInterrupt
        if is_shown and now - last > _STATUS_PERIOD:
            last = now
            say(f"\r\033[K{what} …", sys.stderr, end="")

    try:
        with heard(hear):
            yield
    finally:
        if is_shown:
            say("\r\033[K", sys.stderr, end="")


@contextlib.contextmanager
def _recorded(twin: Any, scene: Any, file: Path | None) -> Iterator[None]:
    """Writes what happens meanwhile as a page that plays back offline, also when it ends in an error."""
    if file is None:
        yield
        return
    from drake_twin.cockpit.html_recording import HtmlRecording

    if not scene.everything():
        scene.set_up(twin)
    recording = HtmlRecording(scene, twin)
    try:
        yield
    finally:
        _write("page", file, recording.finish())


def _open_page(options: argparse.Namespace) -> tuple["_Page | None", Any]:
    """The page, if one is wanted, and the scene to draw, if that is."""
    if options.graphviz is not None:
        return None, None
    if not options.headless:
        page = _Page(options)
        return page, page.scene
    if options.save_html is None:
        return None, None
    from drake_twin.cockpit.scene import Scene

    return None, Scene()


def _again(twin: Any, target: Target, options: argparse.Namespace, watch: Watch) -> tuple[Any, Target, Watch]:
    """The twin of the changed files, or the last good one with what is wrong with them."""
    say(f"changed: {watch.broken_off_by}", sys.stderr)
    files = watch.files
    try:
        with files_read() as files:
            new_target = find_target(options)
            new_twin = build_twin(new_target)
        _announce(new_twin, new_target, options)
    except (TwinError, OSError) as error:
        say(f"error: {error}\nThe last good twin goes on.", sys.stderr)
        return twin, target, Watch(watch.files | files)
    if twin.recorder.is_on:
        new_twin.record()
    new_twin.paused = twin.paused
    new_twin.real_time_rate = twin.real_time_rate
    return new_twin, new_target, Watch(watch.files | files)  # what is cached is not read again, and still counts


def _show_arguments(options: argparse.Namespace) -> int:
    from drake_twin.description.package_index import PackageIndex
    from drake_twin.ros2.evaluate import declared_arguments
    from drake_twin.ros2.show_arguments import arguments_text

    words = [item for item in options.target if ":=" not in item]
    file = find_launch_file(words, package_paths(options))
    if file is None:
        raise InputError("--show-args needs a launch file")
    given = dict(item.split(":=", 1) for item in options.target if ":=" in item)
    say(arguments_text(declared_arguments(file, PackageIndex(package_paths(options)), given)))
    return 0


def _announce(twin: Any, target: Target, options: argparse.Namespace) -> None:
    """Says what came of the files."""
    for line in target.log:
        say(f"launch: {line}", sys.stderr)
    for kind, sentence in grouped(twin.findings):
        say(f"{kind}: {sentence}", sys.stderr)
    if lost := counted(twin.findings, options.strict):
        raise InputError(f"--strict: {strict_text(lost)}, see above")
    if target.paused:
        what = "it runs all the same" if options.headless else "press Play"
        say(f"launch: the simulator starts paused there (gz without -r): {what}", sys.stderr)
    if options.topics or options.controllers:
        from drake_twin.cli.ros2_text import controllers_text, topics_text

        asked = [
            text for text, wanted in ((topics_text, options.topics), (controllers_text, options.controllers)) if wanted
        ]
        say("\n".join(text(twin) for text in asked))
    for topic in options.echo:
        from drake_twin.cli.ros2_text import message_text

        twin.subscribe(topic, lambda message: say(message_text(message)))


def _simulate(
    twin: Any,
    target: Target,
    page: "_Page | None",
    options: argparse.Namespace,
    stopped: Sequence[int],
    watch: Watch | None,
    observers: "_Observers",
) -> None:
    """Runs to the end, until stopped or until a file changes."""
    status = _StatusLine(twin)
    obey = _nothing if page is None else page.show(twin, target)
    observe = observers.show(twin)

    def each_frame() -> bool:
        obey()
        observe()
        status.show()
        return not stopped and (watch is None or not watch.breaks_off())

    try:
        twin.run(
            None if options.duration is None else twin.time + options.duration,
            each_frame=each_frame,
            as_fast_as_possible=page is None and options.viewer is None and options.real_time_rate is None,
        )
    finally:
        status.end()
    observe()


def _nothing() -> None:
    """Without a page there is nothing to obey."""


class _Page:
    """The page in the browser, announced when it has something to show."""

    def __init__(self, options: argparse.Namespace):
        from drake_twin.cockpit.served_page import ServedPage

        self._page = ServedPage(options.port, options.host)
        self._open_browser = not options.no_browser
        self._shown: Any = None
        self._obey: Callable[[], None] = _nothing
        self.scene = self._page.scene

    def show(self, twin: Any, target: Target) -> Callable[[], None]:
        """Shows a twin; returns what does as the page's controls say."""
        if twin is self._shown:
            return self._obey
        self._obey = self._page.show(twin, only_displayed=target.only_displayed).process_requests
        if self._shown is None:
            announce_page(self._page.url, open_browser=self._open_browser)
            if not self._page.server.access.is_local:
                say("open to other machines: whoever has this address sees and commands the robots", sys.stderr)
        self._shown = twin
        return self._obey


class _Observers:
    """The shared page and the plot, which take note of a run and change nothing in it."""

    def __init__(self, options: argparse.Namespace, stopped: Sequence[int]):
        self._options = options
        self._stopped = stopped
        self._viewer: Any = None
        self._recorder: Any = None

    def __enter__(self) -> "_Observers":
        options = self._options
        if options.viewer is not None:
            from drake_twin.shared_viewer.shared_viewer import SharedViewer

            name = options.viewer_name or f"{target_name(options)}-{os.getpid()}"
            self._viewer = SharedViewer(
                options.viewer, name, lambda url: say(f"shared page: {url} (folder twins/{name})")
            )
        if options.plot is not None:
            from drake_twin.cli.history import HistoryRecorder

            self._recorder = HistoryRecorder()
        return self

    def show(self, twin: Any) -> Callable[[], None]:
        """Observes a twin from now on; returns what is to be called each frame."""
        if self._recorder is not None:
            self._recorder.record(twin)
        return _nothing if self._viewer is None else lambda: self._viewer.draw(twin)

    def __exit__(self, *_: object) -> None:
        if self._viewer is not None:
            end = time.monotonic() + _END_WAIT
            while self._viewer.is_behind and not self._stopped and time.monotonic() < end:
                self._viewer.flush(_STATUS_PERIOD)
            self._viewer.close(_STOPPED_WAIT)
        if self._recorder is not None:
            from drake_twin.cli.plot import write_plot

            write_plot(self._recorder.history(), self._options.plot)


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


def _save(twin: Any, wall_time: float, options: argparse.Namespace, failure: RunError | None) -> RunError | None:
    """Writes what is to be kept of a run; one file that cannot be written does not keep another from it.

    Returns:
        What went wrong first, in the run or here; what went wrong after it is said.
    """
    endings: list[Callable[[], None]] = []
    if options.save_state is not None:
        endings.append(lambda: twin.snapshot().save(options.save_state))
    if options.record is not None:
        endings.append(lambda: twin.recording().save(options.record))
    endings.append(partial(_report, twin, wall_time, options.summary, failure))
    for write in endings:
        try:
            write()
        except RunError as error:
            if failure is not None:
                say(f"error: {error}", sys.stderr)
            failure = failure or error
    return failure


def _report(twin: Any, wall_time: float, file: Path | None, failure: RunError | None) -> None:
    from drake_twin.cli.summary import summary

    result = summary(twin, wall_time, failure)
    count = len(result["robots"])
    say(
        f"{count} robot{'s' if count > 1 else ''}, {result['sim_time']:.3f} s simulated in {wall_time:.3f} s"
        f" (real-time factor {result['real_time_factor']:.2f}), state {result['state_sha256'][:12]}"
    )
    if file is not None:
        _write("summary", file, json.dumps(result, indent=2) + "\n")


def _write(what: str, file: Path, text: str) -> None:
    try:
        write_whole(file, text)
    except OSError as error:
        raise RunError(f"the {what} {file} cannot be written ({error.strerror})") from None


if __name__ == "__main__":
    leave(main())
