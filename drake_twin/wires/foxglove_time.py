"""A twin's time in Foxglove's player: play, pause and speed as in the page; going to the start is a reset."""

import logging
from collections.abc import Callable
from concurrent.futures import Future, wait
from typing import TYPE_CHECKING, Any

from drake_twin.errors import TwinError
from drake_twin.twin.twin import Twin

if TYPE_CHECKING:
    from foxglove.websocket import PlaybackState

_log = logging.getLogger(__name__)
_LONGEST = 5.0  # s of wall time in which a twin answers
END = 3600.0  # s: the end of the player's time line for a run without one


class FoxgloveTime:
    """Controls a twin's time as clients ask, and tells them what others make of it.

    Args:
        twin: The twin.
        tell: Is called with the state of its time when others than clients have changed it.
    """

    def __init__(self, twin: Twin, tell: "Callable[[PlaybackState], None]") -> None:
        self._twin, self._tell = twin, tell
        self._told = self._now()
        self._has_seeked = False
        twin.inbox.looks.append(self._look)

    def request(self, request: Any) -> "PlaybackState | None":
        """Do what a client asks, in a thread of the server; None if the twin does not answer."""
        done: Future[PlaybackState] = Future()

        def act() -> None:
            self._control(request)
            done.set_result(self._state())

        if not self._twin.inbox.put(act, between_advances=True):
            return None
        wait([done], _LONGEST)
        return done.result() if done.done() else None

    def close(self) -> None:
        """Control and tell nothing more."""
        self._twin.inbox.looks.remove(self._look)

    def _control(self, request: Any) -> None:
        from foxglove.websocket import PlaybackCommand

        twin, self._has_seeked = self._twin, False
        try:
            twin.clock.real_time_rate = round(request.playback_speed, 6)  # it comes in single precision
            if request.playback_command == PlaybackCommand.Pause:
                twin.pause()
            elif twin.frames.lockstep:
                _log.warning("foxglove: the twin runs in lock-step: it advances only when services say so")
            else:
                twin.play()
            if request.seek_time == 0:
                twin.reset()
                self._has_seeked = True
            elif request.seek_time is not None:
                _log.warning("foxglove: the twin goes to no other time than its start")
        except TwinError as error:
            _log.warning("foxglove: %s", error)

    def _look(self) -> None:
        """Tell of a change, between two advances."""
        if self._now() != self._told:
            self._has_seeked = False
            self._tell(self._state())

    def _now(self) -> tuple[bool, float]:
        return self._twin.clock.paused, self._twin.clock.real_time_rate

    def _state(self) -> "PlaybackState":
        from foxglove.websocket import PlaybackState, PlaybackStatus

        self._told = is_paused, rate = self._now()
        status = PlaybackStatus.Paused if is_paused else PlaybackStatus.Playing
        return PlaybackState(status, round(self._twin.time * 1e9), rate, self._has_seeked, None)
