"""A run as one self-contained page, which plays back in a browser without a network."""

import contextlib
from collections.abc import Callable

from pydrake.geometry import Meshcat, MeshcatAnimation

from drake_twin.twin import Twin

_DRAWN = 32.0  # pictures a second of simulation time
_FRAMES_PER_SECOND = 64.0  # of the recording: what the run loop draws in between finds a frame of its own


class HtmlRecording:
    """Records what is drawn on a Meshcat page from now on, on a grid of simulation times.

    Args:
        meshcat: the page; nobody needs to look at it.
        twin: the twin that is drawn there.
    """

    def __init__(self, meshcat: Meshcat, twin: Twin):
        self._meshcat = meshcat
        self._twin = twin
        self._last_time = twin.time
        self._start()
        self._end_subscription: Callable[[], None] = twin.subscribe("/clock", lambda _: self._draw(), rate=_DRAWN)
        self._draw()

    def _start(self) -> None:
        self._meshcat.DeleteRecording()
        self._meshcat.StartRecording(frames_per_second=_FRAMES_PER_SECOND)

    def _draw(self) -> None:
        if self._twin.time < self._last_time:  # it was reset, and what was recorded does not lead here
            self._start()
        self._last_time = self._twin.time
        self._twin.draw()

    def finish(self) -> str:
        """Ends the recording.

        Returns:
            The page's HTML.
        """
        self._end_subscription()
        with contextlib.suppress(RuntimeError):  # a twin that has failed may be nowhere
            self._twin.draw()
        self._meshcat.StopRecording()
        self._meshcat.PublishRecording()
        html: str = self._meshcat.StaticHtml()
        self._meshcat.SetAnimation(MeshcatAnimation())  # those who look on go on seeing the present
        self._meshcat.DeleteRecording()
        return html
