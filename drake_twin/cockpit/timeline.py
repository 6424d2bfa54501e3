"""The page's timeline: what was drawn in the last minute can be looked at again, and the twin can go on from there."""

from bisect import bisect_left, bisect_right
from collections import deque
from typing import Any

import numpy as np

from drake_twin.cockpit import protocol
from drake_twin.cockpit.past_drawings import PastDrawings
from drake_twin.cockpit.scene import Scene
from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.shared_viewer.frame_sender import Frame
from drake_twin.shared_viewer.shared_scene import SharedScene
from drake_twin.twin.rewind import Mark, Rewind
from drake_twin.twin.twin import Twin

_SECONDS = 60.0  # s of simulation time
_LEAST_BETWEEN = 0.03  # s of simulation time between two pictures that are kept
_MOST_BYTES = 25_000_000  # of the poses and scenes, and as much again of the moments
_GEOMETRY_BYTES = 430  # of each geometry of a scene: each spawn and each delete makes a new one
_MOST_MARKS = 200  # that the page shows
_EPSILON = 1e-9  # s
_LONGEST_FRAME = 0.2  # s of wall time that one frame of a replay makes up for


@dataclass(frozen=True)
class _Picture:
    """What was drawn at a time (s): the bodies' poses in the world, shape (bodies, 3, 4), in half of the memory.

    Its size (bytes) is that of its poses, and of its scene where that is another one than before.
    """

    time: float
    scene: SharedScene
    poses: np.ndarray
    size: int

    @property
    def frame(self) -> Frame:
        poses = np.tile(np.eye(4), (len(self.poses), 1, 1))
        poses[:, :3] = self.poses
        return Frame(self.scene, poses)


class Timeline:
    """Keeps the last minute of a twin while a browser is connected, and draws a moment of it again.

    Time stands still while a moment is looked at; once it continues, the present is drawn again.

    Args:
        twin: The twin.
        scene: The page's scene.
        past: What was drawn besides the robots.

    Attributes:
        loop: Whether a replay begins again where it ends.
    """

    def __init__(self, twin: Twin, scene: Scene, past: PastDrawings):
        self._twin, self._scene, self._past = twin, scene, past
        self._rewind: Rewind | None = None
        self._pictures: deque[_Picture] = deque()
        self._size = 0  # bytes of the pictures
        self._looked: _Picture | None = None
        self._present = 0  # the step at which the looking began
        self._replayed: float | None = None  # the time of a replay (s)
        self._last_frame = 0.0  # wall time (s)
        self.loop = False

    def watch(self, is_watched: bool) -> None:
        """Begin or end to keep moments; those that are there stay."""
        if is_watched and self._rewind is None:
            self._rewind = Rewind(self._twin, _SECONDS, most_bytes=_MOST_BYTES)
        elif self._rewind is not None:
            (self._rewind.open if is_watched else self._rewind.close)()
        if not is_watched:
            self.look_at_now()
        self._past.keep(is_watched)

    def close(self) -> None:
        """Keep and draw nothing more."""
        self.watch(False)
        self._rewind = None

    def draw(self, wall_time: float) -> float | None:
        """Draw the moment that is looked at.

        Args:
            wall_time: Wall time (s), from any origin.

        Returns:
            Its time (s); None if that is the present, which is not drawn here.
        """
        if self._looked is not None and (not self._twin.clock.paused or self._twin.clock.step_count != self._present):
            self.look_at_now()
        if self._replayed is not None:
            self._proceed(wall_time - self._last_frame)
        self._last_frame = wall_time
        if self._looked is None:
            return None
        self._scene.show(self._looked.frame)
        self._past.show(self._looked.time)
        return self._looked.time

    def _proceed(self, seconds: float) -> None:
        """Go on in a replay by some wall time (s)."""
        assert self._replayed is not None
        time = self._replayed + self._twin.clock.real_time_rate * min(seconds, _LONGEST_FRAME)
        last = self._pictures[-1].time
        if time >= last and not self.loop:
            self.look(last)
            return
        self._show(self._pictures[0].time if time >= last else time)
        self._replayed = self._pictures[0].time if time >= last else time

    def note(self, frame: Frame) -> None:
        """Keep what is drawn of the present."""
        if self._rewind is None:
            return
        now = self._twin.time
        self._drop_future()
        if self._pictures and now - self._pictures[-1].time < _LEAST_BETWEEN:
            return
        poses = frame.poses[:, :3].astype(np.float32)
        is_known = self._pictures and self._pictures[-1].scene is frame.scene
        of_scene = 0 if is_known else _GEOMETRY_BYTES * len(frame.scene.geometries)
        self._pictures.append(_Picture(now, frame.scene, poses, poses.nbytes + of_scene))
        self._size += self._pictures[-1].size
        while self._pictures[0].time < now - _SECONDS or (self._size > _MOST_BYTES and len(self._pictures) > 1):
            self._size -= self._pictures.popleft().size

    def tell(self, overlay: object) -> None:
        """Tell what was drawn to an overlay that wants to know it: to its method ``note_past(time, frame)``."""
        if (note := getattr(overlay, "note_past", None)) is not None:
            for picture in self._pictures:
                note(picture.time, picture.frame)

    def do(self, request: protocol.Request) -> None:
        """Process a request about what is looked at.

        Raises:
            InputError: If nothing was drawn yet.
        """
        match request:
            case protocol.Look(time):
                self.look(time)
            case protocol.LookBy(count):
                self.look_by(count)
            case protocol.Replay(on):
                self.replay(on)
            case protocol.Loop(on):
                self.loop = on
            case protocol.LookAtNow():
                self.look_at_now()

    def look(self, time: float) -> None:
        """Pause, and draw the picture that is closest to a time (s) from now on.

        Raises:
            InputError: If nothing was drawn yet.
        """
        self._replayed = None
        self._drop_future()
        if not self._pictures:
            raise InputError("nothing was drawn yet that could be looked at again")
        self._twin.pause()
        self._present = self._twin.clock.step_count
        self._show(time)

    def look_by(self, count: int) -> None:
        """Pause, and look so many pictures after what is looked at, or before it.

        Raises:
            InputError: If nothing was drawn yet.
        """
        self.look(self._twin.time if self._looked is None else self._looked.time)
        at = next(index for index, picture in enumerate(self._pictures) if picture is self._looked)
        self._looked = self._pictures[min(max(0, at + count), len(self._pictures) - 1)]

    def replay(self, on: bool) -> None:
        """Pause, and draw what was drawn from the moment that is looked at on, at the twin's rate, or end that.

        From the last picture, or the present, it begins at the first one.

        Raises:
            InputError: If nothing was drawn yet.
        """
        if not on:
            self._replayed = None
            return
        if self._looked is None or self._looked is self._pictures[-1]:
            self.look(0.0)
        assert self._looked is not None
        self._replayed = self._looked.time

    def _show(self, time: float) -> None:
        """Look at the picture that is closest to a time (s)."""
        times = [picture.time for picture in self._pictures]
        index = bisect_left(times, time)
        near = range(max(0, index - 1), min(len(times), index + 1))
        self._looked = self._pictures[min(near, key=lambda item: abs(times[item] - time))]

    def look_at_now(self) -> None:
        """Draw the present again."""
        self._replayed = None
        if self._looked is not None:
            self._looked = None
            self._past.show_present()

    def go_on_from(self, time: float) -> float:
        """Return the twin to the last moment that is kept before a time (s), and let time continue.

        Returns:
            The time of that moment (s).

        Raises:
            InputError: If no such moment is kept.
        """
        if self._rewind is None:
            raise InputError("no moment is kept yet: the twin has not advanced")
        reached = self._rewind.go_to(time)
        self.look_at_now()
        self._drop_future()
        self._twin.play()
        return reached

    def as_plain(self) -> dict[str, Any] | None:
        """Return what the page shows of it, without the present time; None if nothing is kept.

        ``first`` and ``back_to`` are times (s): the oldest picture, and where the twin would go on from what is looked
        at, None if that moment is not kept.
        """
        if self._rewind is None or not self._pictures:
            return None
        self._drop_future()
        looked = self._looked
        return {
            "first": self._pictures[0].time,
            "looked": None if looked is None else looked.time,
            "replaying": self._replayed is not None,
            "loop": self.loop,
            "back_to": None if looked is None else self._moment_before(looked.time),
            "bytes": self._size + self._rewind.size,
            "marks": [_plain(mark) for mark in self._rewind.marks[-_MOST_MARKS:]],
        }

    def _moment_before(self, time: float) -> float | None:
        times = self._rewind.times if self._rewind is not None else ()
        index = bisect_right(times, time + _EPSILON)
        return times[index - 1] if index else None

    def _drop_future(self) -> None:
        """Drop what is after the present: the twin was returned to an earlier moment."""
        while self._pictures and self._pictures[-1].time > self._twin.time + _EPSILON:
            self._size -= self._pictures.pop().size


def _plain(mark: Mark) -> dict[str, Any]:
    return {"kind": mark.kind, "text": mark.text, "start": round(mark.start, 3), "end": round(mark.end, 3)}
