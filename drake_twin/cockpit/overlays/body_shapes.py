"""Shapes that move with bodies of the plant."""

from collections.abc import Iterable
from typing import NamedTuple

from pydrake.geometry import Rgba, Shape
from pydrake.math import RigidTransform
from pydrake.multibody.tree import BodyIndex

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
    """

    def __init__(self, scene: Scene, twin: Twin, path: str, shapes: Iterable[BodyShape]):
        self._scene = scene
        self._twin = twin
        self._path = path
        self._bodies: dict[int, str] = {}
        for number, item in enumerate(shapes):
            body = self._bodies.setdefault(int(item.body), f"{path}/{int(item.body)}")
            scene.set_object(f"{body}/{number}", item.shape, item.color)
            scene.set_transform(f"{body}/{number}", item.X_BS)

    def draw(self) -> None:
        """Move the shapes to their bodies."""
        plant = self._twin.plant
        poses = plant.get_body_poses_output_port().Eval(plant.GetMyContextFromRoot(self._twin.context))
        for body, path in self._bodies.items():
            self._scene.set_transform(path, poses[body])

    def remove(self) -> None:
        """Remove the shapes."""
        self._scene.delete(self._path)
