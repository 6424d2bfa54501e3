"""What can be drawn besides the robots. An overlay exists while it is shown, so that one that is not costs nothing."""

from typing import Protocol

from drake_twin.cockpit.scene import Scene
from drake_twin.twin.twin import Twin


class Overlay(Protocol):
    """Something drawn in the scene; made with the page's scene and a twin, and again when the twin is rebuilt."""

    def __init__(self, scene: Scene, twin: Twin): ...

    def draw(self) -> None:
        """Draws the present moment."""

    def remove(self) -> None:
        """Takes it off the page."""


def overlay_types() -> dict[str, type[Overlay]]:
    """Name on the wire → the overlay."""
    from drake_twin.cockpit.overlays.collision_shapes import CollisionShapes
    from drake_twin.cockpit.overlays.contact_forces import ContactForces
    from drake_twin.cockpit.overlays.frames import Frames
    from drake_twin.cockpit.overlays.inertia import Inertia

    return {"frames": Frames, "contacts": ContactForces, "collision": CollisionShapes, "inertia": Inertia}
