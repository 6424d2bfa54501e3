"""The commands that take a page from one frame of a twin to the next."""

import logging
from collections.abc import Hashable, Iterator
from itertools import accumulate
from pathlib import Path

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.shared_viewer.meshcat_protocol import Command, TransformWriter, delete, set_object
from drake_twin.shared_viewer.shared_scene import DrawnGeometry, SharedScene
from drake_twin.shared_viewer.three_js import three_js_object

_log = logging.getLogger(__name__)

_MOVED = 1e-6  # m, or in a rotation matrix; smaller motions since the last sent pose are not sent


@dataclass(frozen=True)
class Frame:
    """What to draw of a twin at one time.

    Attributes:
        scene: Its geometry.
        poses: Poses of the scene's bodies in the world, shape (bodies, 4, 4).
    """

    scene: SharedScene
    poses: np.ndarray


class FrameSender:
    """Keeps track of what a page has, and creates the missing commands.

    Args:
        folder: The path below which everything is drawn.

    Attributes:
        transforms: The number of poses in the last frame's commands.
    """

    def __init__(self, folder: str):
        self._folder = folder
        self._scene: SharedScene | None = None
        self._drawn: dict[str, Hashable] = {}
        self._writer = TransformWriter(())
        self._poses = np.empty((0, 4, 4))
        self.transforms = 0

    @property
    def has_sent(self) -> bool:
        """Whether the commands of a frame were created."""
        return self._scene is not None

    @property
    def scene(self) -> SharedScene | None:
        """The geometry that the page has."""
        return self._scene

    def commands(self, frame: Frame) -> Iterator[Command]:
        """Yield the commands that take the page from the last frame to this one."""
        if frame.scene is not self._scene:
            yield from self._other_scene(frame.scene)
            moved = np.arange(len(frame.poses))
            self._poses = frame.poses.copy()
        else:
            moved = np.flatnonzero(np.abs(frame.poses - self._poses).max(axis=(1, 2), initial=0.0) > _MOVED)
            self._poses[moved] = frame.poses[moved]
        self.transforms = len(moved)
        yield from self._writer.commands(frame.poses, moved.tolist())

    def _other_scene(self, scene: SharedScene) -> Iterator[Command]:
        """Yield the commands for changed geometry; a robot that stays is not drawn again when another is added."""
        geometries = {geometry.path: _identity(geometry) for geometry in scene.geometries}
        folders = {folder for path in geometries for folder in _with_parents(path)}
        if self._scene is None:
            yield delete(self._folder)
        gone = {folder for path in self._drawn for folder in _with_parents(path)} - folders
        for folder in sorted(gone):
            if folder.rpartition("/")[0] not in gone:
                yield delete(f"{self._folder}/{folder}")
        for geometry in scene.geometries:
            if self._drawn.get(geometry.path) == geometries[geometry.path]:
                continue
            try:
                three_js = three_js_object(geometry)
            except ValueError as error:
                _log.warning("the shared page does not show %s: %s", geometry.path, error)
                continue
            yield set_object(f"{self._folder}/{geometry.path}", three_js)
        self._scene, self._drawn = scene, geometries
        self._writer = TransformWriter([f"{self._folder}/{body}" for body in scene.bodies])


def _with_parents(path: str) -> list[str]:
    """Return a path after its parents: ``a/b/c`` → ``a``, ``a/b``, ``a/b/c``."""
    return list(accumulate(path.split("/"), lambda parent, name: f"{parent}/{name}"))


def _identity(geometry: DrawnGeometry) -> Hashable:
    """Return a value that is equal for geometries that look the same."""
    source = getattr(geometry.shape, "source", None)
    file = Path(source().path()) if source is not None and source().is_path() else None
    changed = file.stat().st_mtime_ns if file is not None and file.exists() else 0
    return repr(geometry.shape), geometry.color, geometry.X_BG.tobytes(), changed
