"""The shapes that contact is computed with, translucent; their colors show how they touch."""

from collections.abc import Iterator

from pydrake.geometry import HalfSpace, Rgba

from drake_twin.cockpit.overlay import overlay
from drake_twin.cockpit.overlays.body_shapes import BodyShape, BodyShapes
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.diagram.contact import FACES, IN_A_POINT, WHEEL
from drake_twin.twin.twin import Twin

_COLORS = {
    FACES: Rgba(0.16, 0.62, 0.56, 0.45),
    IN_A_POINT: Rgba(0.91, 0.55, 0.16, 0.45),
    WHEEL: Rgba(0.20, 0.45, 0.85, 0.45),
}


@overlay(
    "collision",
    "Collision shapes",
    "Green shapes touch with their faces, orange ones in a point, blue ones are wheels",
    "X",
)
class CollisionShapes(BodyShapes):
    """The collision shapes of all bodies except half spaces, which Meshcat cannot draw."""

    def __init__(self, scene: Scene, twin: Twin):
        super().__init__(scene, twin, f"{OVERLAYS}/collision", _shapes(twin))


def _shapes(twin: Twin) -> Iterator[BodyShape]:
    for item in twin.built.shapes:
        if not isinstance(item.shape, HalfSpace):
            yield BodyShape(item.body, item.X_BG, item.shape, _COLORS[item.touches])
