"""Where the mass is: a ball for each link, and one for each robot as a whole."""

from collections.abc import Iterator
from math import pi

import numpy as np
from pydrake.geometry import Rgba, Sphere
from pydrake.math import RigidTransform

from drake_twin.cockpit.overlay import overlay
from drake_twin.cockpit.overlays.body_shapes import BodyShape, BodyShapes, bodies_with_mass
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.twin.twin import Twin

_PATH = f"{OVERLAYS}/masses"
_LEAD = 11_340.0  # kg/m³
_LINK, _ROBOT = Rgba(0.93, 0.70, 0.13, 0.75), Rgba(0.80, 0.16, 0.42, 0.95)
_MOVED = 1e-5  # m; a smaller motion is not sent


@overlay(
    "masses",
    "Centres of mass",
    "A yellow ball for each link, as large as its mass in lead, and a red one for the whole robot",
    "M",
)
class CentersOfMass(BodyShapes):
    """A ball of lead at the center of mass of each body, and one at that of each robot as a whole."""

    def __init__(self, scene: Scene, twin: Twin):
        super().__init__(scene, twin, _PATH, _shapes(twin), on_top=True)
        self._scene, self._twin = scene, twin
        self._sent: dict[str, np.ndarray] = {}
        plant = twin.plant
        context = plant.GetMyContextFromRoot(twin.context)
        self._instances = {f"{_PATH}/robots/{name}": [parts.instance] for name, parts in twin.built.robots.items()}
        for path, instances in self._instances.items():
            scene.set_object(path, Sphere(_radius(plant.CalcTotalMass(context, instances))), _ROBOT, on_top=True)
            scene.set_property(f"{path}/<object>", "renderOrder", 1)  # over the links' balls

    def draw(self) -> None:
        """Move the balls of the robots whose center of mass has moved."""
        super().draw()
        plant = self._twin.plant
        context = plant.GetMyContextFromRoot(self._twin.context)
        for path, instances in self._instances.items():
            center = plant.CalcCenterOfMassPositionInWorld(context, instances)
            if path not in self._sent or np.abs(center - self._sent[path]).max() > _MOVED:
                self._sent[path] = center
                self._scene.set_transform(path, RigidTransform(center))


def _shapes(twin: Twin) -> Iterator[BodyShape]:
    for body, M_BBo_B in bodies_with_mass(twin):
        yield BodyShape(body, RigidTransform(M_BBo_B.get_com()), Sphere(_radius(M_BBo_B.get_mass())), _LINK)


def _radius(mass: float) -> float:
    """Return the radius (m) of a ball of lead."""
    return float((3 * max(mass, 1e-6) / (4 * pi * _LEAD)) ** (1 / 3))
