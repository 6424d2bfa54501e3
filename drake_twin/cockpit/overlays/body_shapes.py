"""Shapes that move with bodies of the plant."""

from collections.abc import Iterable, Iterator
from math import inf
from typing import NamedTuple

from pydrake.geometry import Rgba, Shape
from pydrake.math import RigidTransform
from pydrake.multibody.tree import BodyIndex, SpatialInertia

from drake_twin.cockpit.overlays.body_folders import BodyFolders
from drake_twin.cockpit.scene import Scene
from drake_twin.twin.twin import Twin


class BodyShape(NamedTuple):
    """A shape on a body.

    Attributes:
        body: The body B.
        X_BS: The pose of the shape S in B.
        shape: The shape.
        color: Its color.
    """

    body: BodyIndex
    X_BS: RigidTransform
    shape: Shape
    color: Rgba


class BodyShapes:
    """Draws shapes on bodies.

    Args:
        scene: The page's scene.
        twin: The twin whose plant has the bodies.
        path: The path in the scene below which the shapes are drawn.
        shapes: The shapes.
        on_top: Whether they are drawn over what hides them.
    """

    def __init__(self, scene: Scene, twin: Twin, path: str, shapes: Iterable[BodyShape], *, on_top: bool = False):
        self._folders = BodyFolders(scene, twin, path)
        for number, item in enumerate(shapes):
            folder, X_FB = self._folders.of(item.body)
            scene.set_object(f"{folder}/{number}", item.shape, item.color, on_top=on_top)
            scene.set_transform(f"{folder}/{number}", X_FB @ item.X_BS)

    def draw(self) -> None:
        """Move the shapes to their bodies, where no browser does."""
        self._folders.draw()

    def remove(self) -> None:
        """Remove the shapes."""
        self._folders.remove()


def bodies_with_mass(twin: Twin) -> Iterator[tuple[BodyIndex, SpatialInertia]]:
    """Yield each body B with mass, and its spatial inertia M_BBo_B."""
    plant = twin.plant
    context = plant.GetMyContextFromRoot(twin.context)
    for number in range(1, plant.num_bodies()):  # 0 is the world
        body = plant.get_body(BodyIndex(number))
        M_BBo_B = body.CalcSpatialInertiaInBodyFrame(context)
        if 0.0 < M_BBo_B.get_mass() < inf:
            yield body.index(), M_BBo_B
