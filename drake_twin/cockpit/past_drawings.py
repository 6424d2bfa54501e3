"""What overlays and sensors drew in the last minute, so that a moment that is looked at has it, too.

The commands that they have sent are kept, not what they were made from: this holds for each overlay, also of other
packages.
"""

from bisect import bisect_right
from collections import deque
from collections.abc import Callable
from dataclasses import field
from weakref import WeakMethod

from drake_twin.cockpit.scene import OVERLAYS, Commands, Scene
from drake_twin.dataclass import dataclass
from drake_twin.shared_viewer.meshcat_protocol import Command, delete

_SECONDS = 60.0  # s of simulation time
_DRAWN_EVERY = 0.1  # s of simulation time: of what is drawn twice in it the later is kept
_PICTURE_EVERY = 0.2  # s, the same for each topic of pictures
_MOST_BYTES = 15_000_000  # of commands, and as much again of pictures
_ROOT = f"{OVERLAYS}/".encode()
_EPSILON = 1e-9  # s


@dataclass
class _Slot:
    """What was drawn from one time to another (s)."""

    begin: float
    end: float
    commands: Commands = field(default_factory=Commands)

    @property
    def size(self) -> int:
        return sum(map(len, self.commands.contents()))


class PastDrawings:
    """Keeps what is drawn besides the robots while it is told to, and draws it again as it was at a time.

    Args:
        time: Returns the present simulation time (s).
        scene: The page's scene.
        send: Sends a sensor's picture to all browsers: its topic, and the picture.

    Attributes:
        close: Ends it.
    """

    def __init__(self, time: Callable[[], float], scene: Scene, send: Callable[[str, bytes], None]):
        self._time, self._scene, self._send = time, scene, send
        self._is_kept = self._is_drawing = False
        self._present = Commands()
        self._shown: Commands | None = None  # what is drawn while a moment is looked at
        self._at: int | None = None  # the slots that are in it
        self._forget_all()
        note = WeakMethod(self._note)  # the scene outlives the twin, and must not keep it
        self.close = scene.listen(lambda commands: (heard := note()) and heard(commands))

    def keep(self, on: bool) -> None:
        """Begin or end to keep what is drawn."""
        if on != self._is_kept:
            self._is_kept = on
            self._forget_all()

    def forget(self, path: str) -> None:
        """Forget what was drawn at a path, and below it: nobody wants to see it any more."""
        gone = delete(path)
        for commands in (self._base, *(slot.commands for slot in self._slots)):
            commands.add([gone], keep_deletions=False)

    def send_picture(self, topic: str, picture: bytes) -> None:
        """Send a sensor's picture, and keep it."""
        if self._is_kept:
            now = self._time()
            kept = self._pictures.setdefault(topic, deque())
            while kept and kept[-1][0] > now - _EPSILON:
                kept.pop()
            self._latest[topic] = picture
            if not kept or now - kept[-1][0] > _PICTURE_EVERY - _EPSILON:
                kept.append((now, picture))
            most = _MOST_BYTES / len(self._pictures)
            while kept[0][0] < now - _SECONDS or (len(kept) * len(picture) > most and len(kept) > 1):
                kept.popleft()
        self._send(topic, picture)

    def show(self, time: float) -> None:
        """Draw what was drawn at a time (s); what is not kept of it is not drawn."""
        at = bisect_right([slot.end for slot in self._slots], time + _EPSILON)
        if self._shown is None or at != self._at:
            self._at = at
            self._draw(self._before() if time < self._first - _EPSILON else self._after(at))
        for topic, kept in self._pictures.items():
            index = bisect_right([at for at, _ in kept], time + _EPSILON)
            if index and self._drawn.get(topic) is not kept[index - 1][1]:
                self._drawn[topic] = kept[index - 1][1]
                self._send(topic, kept[index - 1][1])

    def show_present(self) -> None:
        """Draw the present again."""
        if self._shown is not None:
            self._draw(self._present)
            self._shown = self._at = None
        for topic in self._drawn:
            self._send(topic, self._latest[topic])
        self._drawn.clear()

    def _forget_all(self) -> None:
        drawn = self._scene.everything() if self._is_kept else Commands()
        self._present = drawn.below(_ROOT)
        self._base = self._present.copy()  # what was drawn at the time of `_first`
        self._first = self._time()
        self._slots: deque[_Slot] = deque()
        self._pictures: dict[str, deque[tuple[float, bytes]]] = {}  # topic → the times (s) and pictures
        self._latest: dict[str, bytes] = {}
        self._drawn: dict[str, bytes] = {}  # topic → the past picture that is shown

    def _note(self, commands: list[Command]) -> None:
        """Keep what is drawn; all commands of a list are of the robots, or none is."""
        if not self._is_kept or self._is_drawing or not commands[0][1].startswith(_ROOT):
            return
        now = self._time()
        self._present.add(commands, keep_deletions=False)
        if self._shown is not None:
            self._shown.add(commands, keep_deletions=False)
        while self._slots and self._slots[-1].end > now + _EPSILON:  # the twin was returned to an earlier moment
            self._slots.pop()
        if not self._slots or now - self._slots[-1].begin > _DRAWN_EVERY - _EPSILON:
            self._trim(now)
            self._slots.append(_Slot(now, now))
        self._slots[-1].end = now
        self._slots[-1].commands.add(commands, keep_deletions=True)

    def _trim(self, now: float) -> None:
        size = sum(slot.size for slot in self._slots) if len(self._slots) % 16 == 0 else 0
        while self._slots and (self._slots[0].end < now - _SECONDS or size > _MOST_BYTES):
            slot = self._slots.popleft()
            size -= slot.size
            self._first = slot.end
            self._base.add(slot.commands, keep_deletions=False)

    def _after(self, count: int) -> Commands:
        """Return what was drawn after so many slots."""
        drawn = self._base.copy()
        for slot, _ in zip(self._slots, range(count), strict=False):
            drawn.add(slot.commands, keep_deletions=False)
        return drawn

    def _before(self) -> Commands:
        """Return what has not changed since the first moment that is kept: folders below the root as a whole."""
        changed = {_folder(path) for slot in self._slots for _, path, _ in slot.commands}
        return Commands({key: content for key, content in self._base.items() if _folder(key[1]) not in changed})

    def _draw(self, wanted: Commands) -> None:
        """Draw what is wanted in place of what is drawn."""
        drawn = dict((self._present if self._shown is None else self._shown).items())
        paths = wanted.paths()
        gone = [key[1] for key in drawn if key[0] == b"set_object" and key[1].decode() not in paths]
        commands = [delete(path.decode()) for path in gone]
        commands += [(*key[:2], content) for key, content in wanted.items() if drawn.get(key) is not content]
        self._shown = wanted.copy()
        self._is_drawing = True
        try:
            self._scene.send(commands)
        finally:
            self._is_drawing = False


def _folder(path: bytes) -> bytes:
    return path.removeprefix(_ROOT).partition(b"/")[0]
