"""Shapes that go along with bodies of the plant."""

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
        body: the body B.
        X_BS: the shape in it.
        shape: the shape.
        color: its colour.
    """

    body: BodyIndex
    X_BS: RigidTransform
    shape: Shape
    color: Rgba


class BodyShapes:
    """Draws shapes on bodies.

    Args:
        scene: what the page draws.
        twin: whose plant has the bodies.
        path: where in the scene.
        shapes: the shapes.
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
        """Puts the shapes where their bodies are."""
        plant = self._twin.plant
        poses = plant.get_body_poses_output_port().Eval(plant.GetMyContextFromRoot(self._twin.context))
        for body, path in self._bodies.items():
            self._scene.set_transform(path, poses[body])

    def remove(self) -> None:
        """Takes them off the page."""
        self._scene.delete(self._path)
