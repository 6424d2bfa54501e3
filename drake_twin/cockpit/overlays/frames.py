"""The frames of ``/tf`` and ``/tf_static`` as red, green and blue axes."""

from typing import Any

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.geometry import Cylinder, Rgba
from pydrake.math import RigidTransform, RotationMatrix

from drake_twin.cockpit.overlay import overlay
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.twin.twin import Twin

_LENGTH, _RADIUS = 0.15, 0.004  # m
_COLORS = (Rgba(0.86, 0.2, 0.2), Rgba(0.2, 0.66, 0.26), Rgba(0.2, 0.4, 0.88))


@overlay("frames", "Frames (tf)", "The frames of /tf and /tf_static, with their names", "Y")
class Frames:
    """Axes for each frame, at the pose in ``world`` that a tf listener would compute."""

    def __init__(self, scene: Scene, twin: Twin):
        self._scene = scene
        self._twin = twin
        self._drawn: dict[str, str] = {}

    def draw(self) -> None:
        """Draw the frames that a chain of transforms connects with ``world``."""
        links = {
            link.child_frame_id: link for topic in ("/tf_static", "/tf") for link in _transforms(self._twin, topic)
        }
        known: dict[str, RigidTransform] = {"world": RigidTransform()}
        for name in links:
            pose = _in_world(name, links, known)
            if pose is not None:
                self._scene.set_transform(self._axes(name), pose)

    def remove(self) -> None:
        """Remove the axes."""
        self._scene.delete(f"{OVERLAYS}/frames")
        self._drawn.clear()

    def _axes(self, frame: str) -> str:
        if frame not in self._drawn:
            path = f"{OVERLAYS}/frames/{len(self._drawn)}"
            for axis, color in enumerate(_COLORS):
                direction = np.eye(3)[axis]
                self._scene.set_object(f"{path}/{axis}", Cylinder(_RADIUS, _LENGTH), color)
                turned = RotationMatrix.MakeFromOneVector(direction, 2)
                self._scene.set_transform(f"{path}/{axis}", RigidTransform(turned, 0.5 * _LENGTH * direction))
            self._drawn[frame] = path
        return self._drawn[frame]


def _transforms(twin: Twin, topic: str) -> list[Any]:
    message = twin.latest(topic)
    return [] if message is None else list(message.transforms)


def _in_world(name: str, links: dict[str, Any], known: dict[str, RigidTransform]) -> RigidTransform | None:
    """Return a frame's pose in ``world``; None if no chain of transforms leads there."""
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


def _pose(transform: Any) -> RigidTransform:
    q, p = transform.rotation, transform.translation
    return RigidTransform(Quaternion(np.array([q.w, q.x, q.y, q.z])), [p.x, p.y, p.z])
