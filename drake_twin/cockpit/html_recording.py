"""A run as one self-contained page, which plays back in a browser without a network."""

import base64
import contextlib
import re
from collections.abc import Callable, Iterator
from importlib import resources
from typing import Any

import numpy as np
import umsgpack
from pydrake.math import RotationMatrix

from drake_twin.cockpit.scene import OVERLAYS, TWIN, Scene
from drake_twin.cockpit.server import meshcat_script
from drake_twin.shared_viewer.shared_scene import SharedScene
from drake_twin.twin.twin import Twin

_DRAWN = 32.0  # pictures a second of simulation time
_FRAMES_PER_SECOND = 64.0  # of the recording: what the run loop draws in between finds a frame of its own


class HtmlRecording:
    """Records the poses of all bodies from now on, on a grid of simulation times.

    Args:
        scene: what a page draws; nobody needs to look at it.
        twin: the twin.
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
        if twin.time < self._last_time:  # it was reset, and what was recorded does not lead here
            self._start()
        self._last_time = twin.time
        if self._shown is None or not self._shown.shows(twin):
            self._shown = SharedScene(twin)
        frame = round((twin.time - self._start_time) * _FRAMES_PER_SECOND)
        for body, pose in zip(self._shown.bodies, self._shown.poses(twin), strict=True):
            self._poses.setdefault(body, {})[frame] = pose

    def finish(self) -> str:
        """Ends the recording.

        Returns:
            The page's HTML.
        """
        self._end_subscription()
        with contextlib.suppress(RuntimeError):  # a twin that has failed may be nowhere
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
    """Position and rotation of a body at each frame, as three.js' keys."""
    places = {frame: pose[:3, 3].tolist() for frame, pose in poses.items()}
    turns = {frame: np.roll(RotationMatrix(pose[:3, :3]).ToQuaternion().wxyz(), -1) for frame, pose in poses.items()}
    for name, kind, values in (
        ("position", "vector3", places),
        ("quaternion", "quaternion", {frame: turn.tolist() for frame, turn in turns.items()}),
    ):
        keys = [{"time": frame, "value": value} for frame, value in values.items()]
        yield {"name": f".{name}", "type": kind, "keys": keys}


def _page(commands: list[bytes]) -> str:
    """The scene's page with its scripts, its style and the commands in it."""
    static = resources.files("drake_twin.cockpit").joinpath("static")
    parts = {
        "/* scene.css */": static.joinpath("scene.css").read_text(),
        # A script ends at the first "</script", also in a text of its own.
        "/* meshcat.js */": meshcat_script().decode().replace("</script", "<\\/script"),
        "/* viewer.js */": static.joinpath("viewer.js").read_text(),
        "(commands)": "\n".join(base64.b64encode(command).decode() for command in commands),
    }
    page = static.joinpath("recorded.html").read_text()
    return re.sub("|".join(map(re.escape, parts)), lambda mark: parts[mark[0]], page)
