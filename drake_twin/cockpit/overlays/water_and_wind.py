"""The surfaces of a world's water, and an arrow for its wind."""

from collections.abc import Iterator
from math import sqrt

import numpy as np
from pydrake.geometry import Box, Cylinder, MeshcatCone, Rgba
from pydrake.math import RigidTransform

from drake_twin.cockpit.overlay import overlay
from drake_twin.cockpit.overlays.arrows import arrow_poses
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.diagram.world_in_plant import present_wind, wind_of
from drake_twin.shared_viewer.meshcat_protocol import TransformWriter
from drake_twin.shared_viewer.shared_scene import place_of_robots
from drake_twin.twin.twin import Twin

_PATH = f"{OVERLAYS}/fluids"
_WIND, _LABEL = f"{_PATH}/wind", f"{_PATH}/speed"
_SIDE, _FLAT = 100.0, 0.002  # m: as large as the ground
_LIGHT = 50.0  # kg/m³: a lighter fluid is a gas
_WATER, _GAS = Rgba(0.16, 0.45, 0.78, 0.35), Rgba(0.75, 0.80, 0.85, 0.25)
_SPEED_PER_METER = 5.0  # m/s
_STILL = 0.05  # m/s; a smaller wind, or change of it, is not drawn
_COLOR = Rgba(0.10, 0.55, 0.75)
_RADIUS, _HEAD = 0.02, 0.15  # m
_ABOVE = 1.0  # m, above the middle of the robots


@overlay(
    "fluids",
    "Water and wind",
    "The surfaces of the water, 100 m wide; the wind with its speed, 1 m for 5 m/s",
    "U",
)
class WaterAndWind:
    """A translucent plane where the density of a world's fluid changes, and the velocity of its air over the robots.

    A surface is sent once, and the wind where it has changed.
    """

    def __init__(self, scene: Scene, twin: Twin):
        self._scene, self._twin = scene, twin
        for number, (height, is_liquid) in enumerate(_surfaces(twin)):
            path = f"{_PATH}/surfaces/{number}"
            scene.set_object(path, Box(_SIDE, _SIDE, _FLAT), _WATER if is_liquid else _GAS)
            scene.set_transform(path, RigidTransform([0.0, 0.0, height - _FLAT / 2]))
        self._steady = wind_of(twin.built.world, twin.built.world_file)
        self._drawn = np.zeros(3)
        self._text, self._is_made = "", False
        self._place = place_of_robots(twin)[0] + np.array([0.0, 0.0, _ABOVE])

    def draw(self) -> None:
        """Draw the present wind."""
        wind = np.array(present_wind(self._twin.diagram, self._twin.context, self._steady))
        if np.abs(wind - self._drawn).max() < _STILL:
            return
        self._drawn = wind
        speed = sqrt(float(wind @ wind))
        if speed >= _STILL and not self._is_made:
            self._scene.set_object(f"{_WIND}/shaft", Cylinder(_RADIUS, 1.0), _COLOR)
            self._scene.set_object(f"{_WIND}/head", MeshcatCone(_HEAD, 3 * _RADIUS, 3 * _RADIUS), _COLOR)
            self._scene.set_transform(_LABEL, RigidTransform(self._place))
            self._is_made = True
        for path in (_WIND, _LABEL):
            self._scene.set_property(path, "visible", speed >= _STILL)
        if speed < _STILL:
            return
        paths = TransformWriter([_WIND, f"{_WIND}/shaft", f"{_WIND}/head"])
        self._scene.move(paths, arrow_poses(self._place[None, :], wind[None, :] / _SPEED_PER_METER, _HEAD))
        if (text := f"wind {speed:.1f} m/s") != self._text:
            self._text = text
            self._scene.set_lines(_LABEL, np.zeros((2, 3)), (_COLOR.r(), _COLOR.g(), _COLOR.b()), label=text)

    def remove(self) -> None:
        """Remove everything."""
        self._scene.delete(_PATH)


def _surfaces(twin: Twin) -> Iterator[tuple[float, bool]]:
    """Yield the height of each surface (m), and whether it is that of a liquid."""
    world_file = twin.built.world_file
    if world_file is None or not world_file.forces:
        return
    from drake_twin.description.plugins.buoyancy import BUOYANCY

    for plugin in world_file.forces:
        if plugin.type == BUOYANCY:
            below = plugin.parameters.density
            for height, density in plugin.parameters.changes:
                if density != below:
                    yield height, max(below, density) >= _LIGHT
                below = density
