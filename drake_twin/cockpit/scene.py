"""The page's scene: what is in it now, as the commands of Meshcat's protocol that draw it.

Drake's own Meshcat serves whoever reaches its port, without a token, and ends the process on a message that it cannot
read. So the page draws with Meshcat's JavaScript and gets its commands from here, over the page's own server.
"""

import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import umsgpack
from pydrake.geometry import Rgba, Shape
from pydrake.math import RigidTransform

from drake_twin.shared_viewer.frame_sender import Frame, FrameSender
from drake_twin.shared_viewer.meshcat_protocol import Command, delete, set_object, set_property, set_transform
from drake_twin.shared_viewer.shared_scene import DrawnGeometry, SharedScene, place_of_robots
from drake_twin.shared_viewer.three_js import three_js_object
from drake_twin.twin.twin import Twin

TWIN = "/twin"  # the folder of the twin's bodies
OVERLAYS = "/overlays"  # of what is drawn besides them

# Even light: Meshcat's point lights, a few metres up, would leave two bright spots on the ground.
_LIGHTS = {
    "AmbientLight": 1.8,
    "FillLight": 2.0,
    "SpotLight": 30.0,
    "PointLightNegativeX": 0.0,
    "PointLightPositiveX": 0.0,
}
_SKY_TOP, _SKY_BOTTOM = [0.55, 0.70, 0.86], [0.93, 0.95, 0.97]

CommandKey = tuple[bytes, ...]


class Commands:
    """Commands of which a later one replaces an earlier one, so that there are never more than the scene has parts."""

    def __init__(self, commands: Mapping[CommandKey, bytes] | None = None):
        self._known: dict[CommandKey, bytes] = dict(commands or {})

    def __len__(self) -> int:
        return len(self._known)

    def copy(self) -> "Commands":
        """The same commands."""
        return Commands(self._known)

    def add(self, commands: Iterable[Command], *, keep_deletions: bool) -> None:
        """Takes commands, in their order.

        Args:
            commands: the commands.
            keep_deletions: whether whoever is told these has seen what is deleted.
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

    def packed(self) -> bytes:
        """All of them as one MessagePack array."""
        return b"\xdd" + len(self._known).to_bytes(4, "big") + b"".join(self._known.values())

    def contents(self) -> list[bytes]:
        """Each as MessagePack, in order."""
        return list(self._known.values())

    def paths(self) -> set[str]:
        """Where something is drawn."""
        return {path.decode() for kind, path, *_ in self._known if kind == b"set_object"}


class Scene:
    """What a page draws.

    It belongs to the thread that simulates; only `everything` may be called from another one.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._commands = Commands()
        self._listeners: list[Callable[[list[Command]], None]] = []
        self._sender = FrameSender(TWIN)
        self._drawn: SharedScene | None = None

    def listen(self, listener: Callable[[list[Command]], None]) -> None:
        """Calls back with each command from now on."""
        self._listeners.append(listener)

    def everything(self) -> Commands:
        """The commands that draw the present scene on an empty page."""
        with self._lock:
            return self._commands.copy()

    def has_path(self, path: str) -> bool:
        """Whether something is drawn at or below a path."""
        return any(drawn == path or drawn.startswith(f"{path}/") for drawn in self.everything().paths())

    def set_object(self, path: str, shape: Shape, color: Rgba) -> None:
        """Draws a shape at a path, in place of the one that is there."""
        rgba = (color.r(), color.g(), color.b(), color.a())
        self._tell([set_object(path, three_js_object(DrawnGeometry(path, shape, rgba, np.eye(4))))])

    def set_transform(self, path: str, X_PF: RigidTransform | np.ndarray) -> None:
        """Puts a path F, and all below it, somewhere in the path P above it; a 4x4 matrix may stretch it, too."""
        matrix = X_PF.GetAsMatrix4() if isinstance(X_PF, RigidTransform) else X_PF
        self._tell([set_transform(path, matrix)])

    def set_property(self, path: str, name: str, value: Any) -> None:
        """Sets a property of three.js."""
        self._tell([set_property(path, name, value)])

    def delete(self, path: str) -> None:
        """Removes a path and all below it."""
        self._tell([delete(path)])

    def set_camera_pose(self, position: Sequence[float] | np.ndarray, target: Sequence[float] | np.ndarray) -> None:
        """Looks from one place at another (m, in the world); three.js' y points up."""
        there, here = ([float(x), float(z), -float(y)] for x, y, z in (target, position))
        content = umsgpack.packb({"type": "set_target", "path": "", "value": there})
        self._tell([(b"set_target", b"", content)])
        self.set_property("/Cameras/default/rotated/<object>", "position", here)

    def set_up(self, twin: Twin) -> None:
        """Sets sky and lights, and looks at all robots from the front left."""
        self.set_property("/Background/<object>", "top_color", _SKY_TOP)
        self.set_property("/Background/<object>", "bottom_color", _SKY_BOTTOM)
        self.set_property("/Axes/<object>", "visible", False)
        for light, intensity in _LIGHTS.items():
            self.set_property(f"/Lights/{light}/<object>", "intensity", intensity)
        center, reach = place_of_robots(twin)
        self.set_camera_pose(center + reach * np.array([0.75, -0.65, 0.65]), center)

    def draw(self, twin: Twin) -> None:
        """Draws a twin's present state; it may be another twin than the last time, or have other robots."""
        if self._drawn is None or not self._drawn.shows(twin):
            self._drawn = SharedScene(twin)
        self._tell(list(self._sender.commands(Frame(self._drawn, self._drawn.poses(twin)))))

    def _tell(self, commands: list[Command]) -> None:
        if not commands:
            return
        with self._lock:
            self._commands.add(commands, keep_deletions=False)
        for listener in self._listeners:
            listener(commands)


def _property_of(content: bytes) -> bytes:
    return str(umsgpack.unpackb(content)["property"]).encode()
