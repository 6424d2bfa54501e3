"""A run as one self-contained HTML page that plays back in a browser without a network."""

import base64
import contextlib
import re
from collections.abc import Callable, Iterator
from importlib import resources
from typing import Any

import numpy as np
import umsgpack
from pydrake.math import RotationMatrix

from drake_twin.cockpit.scene import OVERLAYS, TWIN, Scene, meshcat_script
from drake_twin.shared_viewer.shared_scene import SharedScene
from drake_twin.twin.twin import Twin
from drake_twin.versions import stamp

_DRAWN = 32.0  # poses a second of simulation time
_FRAMES_PER_SECOND = 64.0  # of the recording: poses between two of the grid get a frame of their own


class HtmlRecording:
    """Records the poses of all bodies from its creation on, on a grid of simulation times.

    Args:
        scene: The scene that the page draws; no browser needs to be connected.
        twin: The twin.
    """

    def __init__(self, scene: Scene, twin: Twin):
        self._scene = scene
        self._twin = twin
        self._end_subscription: Callable[[], None] = twin.subscribe("/clock", lambda _: self._note(), rate=_DRAWN)
        self._start()
        self._note()

    def _start(self) -> None:
        self._start_time = self._last_time = self._twin.time
        self._shown: SharedScene | None = None
        self._poses: dict[str, dict[int, np.ndarray]] = {}

    def _note(self) -> None:
        twin = self._twin
        if twin.time < self._last_time:  # it was reset: what was recorded before does not lead to this state
            self._start()
        self._last_time = twin.time
        if self._shown is None or not self._shown.shows(twin):
            self._shown = SharedScene(twin)
        frame = round((twin.time - self._start_time) * _FRAMES_PER_SECOND)
        for body, pose in zip(self._shown.bodies, self._shown.poses(twin), strict=True):
            self._poses.setdefault(body, {})[frame] = pose

    def finish(self) -> str:
        """End the recording.

        Returns:
            The page's HTML.
        """
        self._end_subscription()
        with contextlib.suppress(RuntimeError):  # after a failure the twin may have no poses
            self._note()
            self._scene.draw(self._twin)
        commands = self._scene.everything()
        commands.add([(b"delete", OVERLAYS.encode(), b"")], keep_deletions=False)
        return _page([*commands.contents(), umsgpack.packb(self._animation())])

    def _animation(self) -> dict[str, Any]:
        return {
            "type": "set_animation",
            "path": "",
            "animations": [
                {
                    "path": f"{TWIN}/{body}",
                    "clip": {"fps": _FRAMES_PER_SECOND, "name": "default", "tracks": list(_tracks(poses))},
                }
                for body, poses in self._poses.items()
            ],
            "options": {"play": True, "loopMode": 2201, "repetitions": 1, "clampWhenFinished": True},
        }


def _tracks(poses: dict[int, np.ndarray]) -> Iterator[dict[str, Any]]:
    """Yield the position and rotation tracks of a body as three.js' keyframes."""
    places = {frame: pose[:3, 3].tolist() for frame, pose in poses.items()}
    turns = {frame: np.roll(RotationMatrix(pose[:3, :3]).ToQuaternion().wxyz(), -1) for frame, pose in poses.items()}
    for name, kind, values in (
        ("position", "vector3", places),
        ("quaternion", "quaternion", {frame: turn.tolist() for frame, turn in turns.items()}),
    ):
        keys = [{"time": frame, "value": value} for frame, value in values.items()]
        yield {"name": f".{name}", "type": kind, "keys": keys}


def _page(commands: list[bytes]) -> str:
    """Return the page with its scripts, its style and the scene's commands inlined."""
    static = resources.files("drake_twin.cockpit").joinpath("static")
    parts = {
        "(generator)": stamp(),
        "/* scene.css */": static.joinpath("scene.css").read_text(),
        # A browser ends a script at the first "</script", also inside a string.
        "/* meshcat.js */": meshcat_script().decode().replace("</script", "<\\/script"),
        "/* viewer.js */": static.joinpath("viewer.js").read_text(),
        "/* surroundings.js */": static.joinpath("surroundings.js").read_text(),
        "(commands)": "\n".join(base64.b64encode(command).decode() for command in commands),
    }
    page = static.joinpath("recorded.html").read_text()
    return re.sub("|".join(map(re.escape, parts)), lambda mark: parts[mark[0]], page)
