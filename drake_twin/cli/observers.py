"""The shared page, the plot and the film of a run, which observe it and change nothing in it."""

import argparse
import os
import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from drake_twin.cli.options import film_format
from drake_twin.cli.target import target_name
from drake_twin.program import say, write_each

if TYPE_CHECKING:
    from drake_twin.cli.history import HistoryRecorder
    from drake_twin.film.film import Film
    from drake_twin.shared_viewer.shared_viewer import SharedViewer
    from drake_twin.twin.twin import Twin

_FLUSH = 0.2  # s between two looks at the signals while a shared page catches up
_END_WAIT, _STOPPED_WAIT = 10.0, 0.5  # s that a shared page has to take a run's last state


class Observers:
    """The observers that the options ask for; a context manager that finishes them at its end.

    Args:
        options: The options of ``drake_twin.run``.
        stopped: The signals that have arrived.
    """

    def __init__(self, options: argparse.Namespace, stopped: Sequence[int]):
        self._options = options
        self._stopped = stopped
        self._viewer: SharedViewer | None = None
        self._recorder: HistoryRecorder | None = None
        self._film: Film | None = None

    def __enter__(self) -> "Observers":
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
        if options.film is not None:
            from drake_twin.film.film import Film

            self._film = Film(options.film, film_format(options))
        return self

    def observe(self, twin: "Twin") -> Callable[[], None]:
        """Observe a twin from now on; return the function to call each frame."""
        if self._recorder is not None:
            self._recorder.record(twin)
        if self._film is not None:
            self._film.shoot(twin)
        viewer = self._viewer
        return (lambda: None) if viewer is None else (lambda: viewer.draw(twin))

    def __exit__(self, *_: object) -> None:
        if self._viewer is not None:
            end = time.monotonic() + _END_WAIT
            while self._viewer.is_behind and not self._stopped and time.monotonic() < end:
                self._viewer.flush(_FLUSH)
            self._viewer.close(_STOPPED_WAIT)
        writers: list[Callable[[], None]] = []
        if self._recorder is not None:
            from drake_twin.cli.plot import write_plot

            history = self._recorder.history()
            writers.append(lambda: write_plot(history, self._options.plot))
        if self._film is not None:
            writers.append(self._film.finish)
        if (failure := write_each(writers, None)) is not None:
            raise failure
