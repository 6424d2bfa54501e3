"""The page's scene: the commands of Meshcat's protocol that draw its present content.

Drake's own Meshcat serves anyone who can reach its port, without a token, and ends the process on a malformed message.
So the page draws with Meshcat's JavaScript and receives these commands over its own server.
"""

import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import umsgpack
from pydrake.geometry import Rgba, Shape
from pydrake.math import RigidTransform

from drake_twin.shared_viewer.frame_sender import Frame, FrameSender
from drake_twin.shared_viewer.meshcat_protocol import (
    Command,
    TransformWriter,
    delete,
    set_object,
    set_property,
    set_transform,
)
from drake_twin.shared_viewer.shared_scene import DrawnGeometry, SharedScene, place_of_robots
from drake_twin.shared_viewer.three_js import ghost_object, lines_object, points_object, three_js_object
from drake_twin.twin.twin import Twin

TWIN = "/twin"  # the path of the twin's bodies
OVERLAYS = "/overlays"  # the path of the overlays

_ON_TOP = {"depthTest": False, "depthWrite": False, "transparent": True}  # of materials: drawn after all else

CommandKey = tuple[bytes, ...]


class Commands:
    """Commands by kind and path; a later one replaces an earlier one, so that their number is bounded by the scene."""

    def __init__(self, commands: Mapping[CommandKey, bytes] | None = None):
        self._known: dict[CommandKey, bytes] = dict(commands or {})

    def __len__(self) -> int:
        return len(self._known)

    def copy(self) -> "Commands":
        """Return a copy."""
        return Commands(self._known)

    def add(self, commands: Iterable[Command], *, keep_deletions: bool) -> None:
        """Add commands in their order.

        Args:
            commands: The commands.
            keep_deletions: Whether to keep commands that delete: for a browser that has drawn what is deleted.
        """
        for kind, path, content in commands:
            if kind == b"delete":
                below = path.rstrip(b"/") + b"/"
                for key in [key for key in self._known if key[1] == path or key[1].startswith(below)]:
                    del self._known[key]
                if not keep_deletions:
                    continue
            key = (kind, path, _property_of(content)) if kind == b"set_property" else (kind, path)
            self._known.pop(key, None)
            self._known[key] = content

    def __iter__(self) -> Iterator[Command]:
        for key, content in self._known.items():
            yield key[0], key[1], content

    def items(self) -> Iterable[tuple[CommandKey, bytes]]:
        """Return the commands with their keys: kind, path, and the name of a property."""
        return self._known.items()

    def below(self, root: bytes) -> "Commands":
        """Return those whose paths begin with a text."""
        return Commands({key: content for key, content in self._known.items() if key[1].startswith(root)})

    def packed(self) -> bytes:
        """Return all commands as one MessagePack array."""
        return b"\xdd" + len(self._known).to_bytes(4, "big") + b"".join(self._known.values())

    def contents(self) -> list[bytes]:
        """Return each command as MessagePack, in order."""
        return list(self._known.values())

    def paths(self) -> set[str]:
        """Return the paths of the objects."""
        return {path.decode() for kind, path, *_ in self._known if kind == b"set_object"}


class Scene:
    """The scene of a page.

    It belongs to the thread that simulates; other threads may call `everything` only.
    """

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._commands = Commands()
        self._listeners: list[Callable[[list[Command]], None]] = []
        self._write_later: Callable[[Callable[[], None]], None] = lambda write: write()
        self._moved: Frame | None = None  # its poses are still to be written
        self._sender = FrameSender(TWIN)
        self._drawn: SharedScene | None = None
        self._beside: dict[str, FrameSender] = {}

    def listen(self, listener: Callable[[list[Command]], None]) -> Callable[[], None]:
        """Call a function with each list of commands from now on, in the thread that draws or writes.

        Returns:
            Ends it.
        """
        self._listeners.append(listener)

        def end() -> None:
            if listener in self._listeners:
                self._listeners.remove(listener)

        return end

    def write_in(self, call: Callable[[Callable[[], None]], None]) -> None:
        """Let another thread write the commands of poses.

        In the simulation's thread this takes three times as long: its caches hold what the physics needs.

        Args:
            call: Has a function called in that thread, soon.
        """
        self._write_later = call

    def everything(self) -> Commands:
        """Return the commands that draw the present scene on an empty page."""
        with self._lock:
            self._write()
            return self._commands.copy()

    def has_path(self, path: str) -> bool:
        """Return whether an object is at or below a path."""
        return any(drawn == path or drawn.startswith(f"{path}/") for drawn in self.everything().paths())

    def set_object(self, path: str, shape: Shape, color: Rgba, *, on_top: bool = False) -> None:
        """Draw a shape at a path, in place of the object there; `on_top` draws it over what hides it."""
        rgba = (color.r(), color.g(), color.b(), color.a())
        drawn = three_js_object(DrawnGeometry(path, shape, rgba, np.eye(4)), **(_ON_TOP if on_top else {}))
        self.send([set_object(path, drawn)])

    def set_points(
        self, path: str, points: np.ndarray, color: tuple[float, float, float] | np.ndarray, size: float
    ) -> None:
        """Draw points (m, shape (n, 3)) of a size (m) at a path, in place of what is there; each may have its color."""
        self.send([set_object(path, points_object(path, points, color, size))])

    def set_lines(
        self,
        path: str,
        ends: np.ndarray,
        color: tuple[float, float, float] | np.ndarray,
        *,
        on_top: bool = False,
        label: str = "",
    ) -> None:
        """Draw line segments from the first end to the second, … (m, shape (2 n, 3)) at a path.

        Each end may have its color; `on_top` draws them over what hides them; a label stands at the path's place.
        """
        drawn = lines_object(path, ends, color, **(_ON_TOP if on_top else {}))
        drawn["object"]["userData"] = {"label": label}
        self.send([set_object(path, drawn)])

    def set_ghost(self, path: str, body: str, color: tuple[float, float, float]) -> None:
        """Draw a translucent copy of a body, by its path below the twin's, at a path; the browser has its geometry."""
        self.send([set_object(path, ghost_object(path, body, color))])

    def set_transform(self, path: str, X_PF: RigidTransform | np.ndarray) -> None:
        """Set the pose of a path F, and of all below it, in its parent P; a 4x4 matrix may scale it, too."""
        matrix = X_PF.GetAsMatrix4() if isinstance(X_PF, RigidTransform) else X_PF
        self.send([set_transform(path, matrix)])

    def move(self, paths: TransformWriter, poses: np.ndarray) -> None:
        """Set the poses of all paths of a writer in their parents at once, shape (paths, 4, 4)."""
        self.send(list(paths.commands(poses, range(len(poses)))))

    def set_property(self, path: str, name: str, value: object) -> None:
        """Set a property of three.js to a plain value."""
        self.send([set_property(path, name, value)])

    def delete(self, path: str) -> None:
        """Delete a path and all below it."""
        self.send([delete(path)])

    def set_camera_pose(self, position: Sequence[float] | np.ndarray, target: Sequence[float] | np.ndarray) -> None:
        """Place the camera at a position and turn it to a target (m, in the world)."""
        there, here = ([float(x), float(z), -float(y)] for x, y, z in (target, position))  # three.js is y-up
        content = umsgpack.packb({"type": "set_target", "path": "", "value": there})
        self.send([(b"set_target", b"", content)])
        self.set_property("/Cameras/default/rotated/<object>", "position", here)

    def set_up(self, twin: Twin) -> None:
        """Place the camera to the front left of all robots."""
        center, reach = place_of_robots(twin)
        self.set_camera_pose(center + reach * np.array([0.75, -0.65, 0.4]), center)

    def draw(self, twin: Twin) -> None:
        """Draw a twin's present state; it may be another twin than in the last call, or have other robots."""
        self.show(self.frame(twin))

    def frame(self, twin: Twin) -> Frame:
        """Return what `draw` would draw."""
        scene = self.shared(twin)
        return Frame(scene, scene.poses(twin))

    def shared(self, twin: Twin) -> SharedScene:
        """Return what is drawn of a twin's bodies."""
        if self._drawn is None or not self._drawn.shows(twin):
            self._drawn = SharedScene(twin)
        return self._drawn

    def show(self, frame: Frame) -> None:
        """Draw what may have been drawn before."""
        with self._lock:
            has_shapes = frame.scene is self._sender.scene
            self._moved = frame
            if not has_shapes:  # reads files, which may fail
                self._write()
        if has_shapes:
            self._write_later(self._write)

    def show_beside(self, path: str, frame: Frame, opacity: float) -> None:
        """Draw something else than the twin, such as another run's robots, with an opacity from 0 to 1.

        Args:
            path: The path below which it is drawn.
            frame: What is drawn.
            opacity: Its opacity.
        """
        is_new = path not in self._beside
        sender = self._beside.setdefault(path, FrameSender(path))
        self.send(list(sender.commands(frame)))
        if is_new:
            self.set_property(path, "modulated_opacity", opacity)

    def delete_beside(self, path: str) -> None:
        """Delete what `show_beside` draws at a path."""
        if self._beside.pop(path, None) is not None:
            self.delete(path)

    def _write(self) -> None:
        """Write the poses that are not written yet; only the newest are."""
        with self._lock:
            frame, self._moved = self._moved, None
            if frame is not None:
                self._deliver(list(self._sender.commands(frame)))

    def send(self, commands: list[Command]) -> None:
        """Send commands that draw."""
        with self._lock:
            self._write()
            self._deliver(commands)

    def _deliver(self, commands: list[Command]) -> None:
        if not commands:
            return
        self._commands.add(commands, keep_deletions=False)
        for listener in self._listeners:
            listener(commands)


def _property_of(content: bytes) -> bytes:
    return str(umsgpack.unpackb(content)["property"]).encode()


def meshcat_script() -> bytes:
    """Return Drake's copy of Meshcat's JavaScript."""
    from pydrake.common import FindResourceOrThrow

    return Path(FindResourceOrThrow("drake/geometry/meshcat.js")).read_bytes()
