"""The frames of ``/tf`` and ``/tf_static`` as red, green and blue axes."""

from typing import Any

import numpy as np

from drake_twin.cockpit.overlay import overlay
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.shared_viewer.meshcat_protocol import TransformWriter
from drake_twin.twin.twin import Twin

_LENGTH = 0.15  # m
_COLORS = np.array([(0.86, 0.2, 0.2), (0.2, 0.66, 0.26), (0.2, 0.4, 0.88)])


@overlay("frames", "Frames (tf)", "The frames of /tf and /tf_static, with their names", "Y")
class Frames:
    """Axes for each frame, at the pose in ``world`` that a tf listener would compute."""

    def __init__(self, scene: Scene, twin: Twin):
        self._scene = scene
        self._twin = twin
        self._drawn: dict[str, str] = {}  # frame → its path
        self._names: list[str] = []
        self._paths = TransformWriter(())
        self._time = -1.0

    def draw(self) -> None:
        """Draw the frames that a chain of transforms connects with ``world``."""
        if self._twin.time == self._time:
            return
        self._time = self._twin.time
        links = {
            link.child_frame_id: link for topic in ("/tf_static", "/tf") for link in _transforms(self._twin, topic)
        }
        known: dict[str, np.ndarray] = {"world": np.eye(4)}
        poses = {name: pose for name in links if (pose := _in_world(name, links, known)) is not None}
        if not poses:
            return
        if list(poses) != self._names:
            self._names = list(poses)
            self._paths = TransformWriter([self._axes(name) for name in poses])
        self._scene.move(self._paths, np.array(list(poses.values())))

    def remove(self) -> None:
        """Remove the axes."""
        self._scene.delete(f"{OVERLAYS}/frames")
        self._drawn.clear()

    def _axes(self, frame: str) -> str:
        if frame not in self._drawn:
            path = self._drawn[frame] = f"{OVERLAYS}/frames/{len(self._drawn)}"
            ends = np.stack([np.zeros((3, 3)), _LENGTH * np.eye(3)], axis=1).reshape(-1, 3)
            self._scene.set_lines(path, ends, np.repeat(_COLORS, 2, axis=0), on_top=True, label=frame)
        return self._drawn[frame]


def _transforms(twin: Twin, topic: str) -> list[Any]:
    message = twin.latest(topic)
    return [] if message is None else list(message.transforms)


def _in_world(name: str, links: dict[str, Any], known: dict[str, np.ndarray]) -> np.ndarray | None:
    """Return a frame's pose in ``world`` as a 4x4 matrix; None if no chain of transforms leads there."""
    chain = []
    while name not in known:
        if name not in links or name in chain:
            return None
        chain.append(name)
        name = links[name].header.frame_id
    for child in reversed(chain):
        known[child] = known[name] @ _pose(links[child].transform)
        name = child
    return known[name]


def _pose(transform: Any) -> np.ndarray:
    q, p = transform.rotation, transform.translation
    w, x, y, z = q.w, q.x, q.y, q.z
    s = 2.0 / (w * w + x * x + y * y + z * z)
    return np.array(
        [
            [1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y), p.x],
            [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x), p.y],
            [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y), p.z],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )
