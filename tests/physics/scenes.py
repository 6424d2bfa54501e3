"""Simple things in simple worlds, whose motion mechanics knows: boxes, cylinders, slopes, slabs.

A thing is a robot of one link, written as URDF; a world is an SDF file. Lengths are in m, masses in kg.
"""

from math import cos, radians, sin
from pathlib import Path

import numpy as np
import pytest

from drake_twin import TwinBuilder
from drake_twin.scenario import World

G = 9.81

# What every case is run with.
ENGINES = {
    "1ms": {"time_step": 0.001},
    "10ms": {"time_step": 0.01},
    "cenic": {"engine": "cenic", "accuracy": 1e-3, "time_step": 0.01},
}
every_engine = pytest.mark.parametrize("engine", ENGINES)


def step_error(engine: str) -> float:
    """The step that a semi-implicit method errs by half of (s)."""
    return 0.001 if engine == "1ms" else 0.01


def box(size: tuple[float, float, float], mass: float = 1.0, friction: float | None = None) -> str:
    """URDF of a box of even density."""
    x, y, z = size
    moments = (y * y + z * z, x * x + z * z, x * x + y * y)
    return thing(f'<box size="{x} {y} {z}"/>', mass, [mass / 12 * value for value in moments], friction)


def cylinder(radius: float, length: float, mass: float = 1.0, friction: float | None = None) -> str:
    """URDF of an upright cylinder of even density."""
    side = mass / 12 * (3 * radius**2 + length**2)
    shape = f'<cylinder radius="{radius}" length="{length}"/>'
    return thing(shape, mass, (side, side, mass * radius**2 / 2), friction)


def sphere(radius: float, mass: float = 1.0, friction: float | None = None) -> str:
    """URDF of a ball of even density."""
    return thing(f'<sphere radius="{radius}"/>', mass, [0.4 * mass * radius**2] * 3, friction)


def thing(shape: str, mass: float, moments, friction: float | None = None, center=(0.0, 0.0, 0.0)) -> str:
    """URDF of one link of a shape."""
    ixx, iyy, izz = moments
    surface = (
        "" if friction is None else f'<gazebo reference="body"><mu1>{friction}</mu1><mu2>{friction}</mu2></gazebo>'
    )
    xyz = " ".join(map(str, center))
    return f"""<robot name="thing"><link name="body">
<inertial><origin xyz="{xyz}"/><mass value="{mass}"/>
<inertia ixx="{ixx}" iyy="{iyy}" izz="{izz}" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry>{shape}</geometry></collision></link>{surface}</robot>"""


def world(*models: str, gravity: float = G) -> str:
    """SDF of a world without ground."""
    return f"""<sdf version="1.9"><world name="w"><gravity>0 0 {-gravity}</gravity>{"".join(models)}</world></sdf>"""


def plane(tilt: float = 0.0, friction: float = 1.0) -> str:
    """An endless plane through the origin that falls off along x by an angle (rad)."""
    return static("<plane><normal>0 0 1</normal><size>100 100</size></plane>", (0, 0, 0, 0, tilt, 0), friction)


def static_box(tilt: float = 0.0, friction: float = 1.0, side: float = 200.0) -> str:
    """A box whose upper side is that plane."""
    pose = (-0.5 * sin(tilt), 0, -0.5 * cos(tilt), 0, tilt, 0)
    return static(f"<box><size>{side} {side} 1</size></box>", pose, friction)


def static_mesh(file: Path, tilt: float = 0.0, friction: float = 1.0, side: float = 40.0, cells: int = 7) -> str:
    """A mesh of triangles whose upper side is that plane; its file is written."""
    edges = np.linspace(-side / 2, side / 2, cells + 1)
    lines = [f"v {x} {y} {z}" for z in (0.0, -1.0) for x in edges for y in edges]
    layer, row = (cells + 1) ** 2, cells + 1
    faces = []
    for i in range(cells):
        for j in range(cells):
            a, b, c, d = (i * row + j, (i + 1) * row + j, (i + 1) * row + j + 1, i * row + j + 1)
            faces += [(a, b, c), (a, c, d), (layer + a, layer + c, layer + b), (layer + a, layer + d, layer + c)]
    for i in range(cells):  # the four sides
        for one, other in (((i + 1) * row, i * row), (i, i + 1)):
            faces += [(one, other, layer + other), (one, layer + other, layer + one)]
        for one, other in ((i * row + cells, (i + 1) * row + cells), (cells * row + i + 1, cells * row + i)):
            faces += [(one, other, layer + other), (one, layer + other, layer + one)]
    lines += ["f " + " ".join(str(index + 1) for index in face) for face in faces]
    file.write_text("\n".join(lines))
    return static(f"<mesh><uri>{file}</uri></mesh>", (0, 0, 0, 0, tilt, 0), friction, name="terrain")


def static(geometry: str, pose, friction: float = 1.0, name: str = "floor") -> str:
    """A model that does not move."""
    return f"""<model name="{name}"><static>true</static><pose>{" ".join(map(str, pose))}</pose><link name="l">
<collision name="c"><geometry>{geometry}</geometry><surface><friction><ode>
<mu>{friction}</mu><mu2>{friction}</mu2></ode></friction></surface></collision></link></model>"""


def on_slope(tilt: float, x: float = 0.0, y: float = 0.0, z: float = 0.0):
    """A point given along a slope, in the world (m)."""
    return (x * cos(tilt) + z * sin(tilt), y, -x * sin(tilt) + z * cos(tilt))


class Scene:
    """Collects things and a world, and runs them."""

    def __init__(self, folder: Path, engine: str, floor: str | None = None, **options):
        world_file = None
        if floor is not None:
            world_file = folder / "world.sdf"
            world_file.write_text(world(floor))
        self._folder = folder
        self._builder = TwinBuilder(
            world=World(file=None if world_file is None else str(world_file), **options), **ENGINES[engine]
        )

    def add(self, name: str, urdf: str, xyz, rpy=(0.0, 0.0, 0.0), **options) -> "Scene":
        """Adds a robot or a thing."""
        file = self._folder / f"{name}.urdf"
        file.write_text(urdf)
        self._builder.robot(name, file, xyz=xyz, rpy=rpy, **options)
        return self

    def build(self):
        """The twin."""
        return self._builder.build()


def position(twin, name: str) -> np.ndarray:
    """Where a thing is (m)."""
    return np.array(twin.entities.state(name).position)


def velocity(twin, name: str) -> np.ndarray:
    """How a thing moves (m/s)."""
    return np.array(twin.entities.state(name).linear)


def farthest_from(twin, name: str, place: np.ndarray, until: float, every: float = 0.1) -> float:
    """How far a thing gets from a place (m) until a time (s)."""
    found = 0.0
    while twin.time < until - 1e-9:
        twin.advance_to(min(twin.time + every, until))
        found = max(found, float(np.linalg.norm(position(twin, name) - place)))
    return found


TWELVE = radians(12.0)
