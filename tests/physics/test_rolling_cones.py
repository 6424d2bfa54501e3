"""Loose cones, cups and buckets roll on their side about their apex, and STL cylinders as cylinders do.

Lying on a plane, such a body turns about its contact line. On the level it keeps its rate; on a slope it swings about
its apex as a pendulum.
"""

from dataclasses import dataclass
from math import asin, atan2, cos, pi, radians, sin, sqrt

import numpy as np
import pytest
import trimesh
from scenes import G, Scene, every_engine, on_slope, plane, position, static_box, thing, velocity
from trimesh.transformations import euler_from_matrix, quaternion_matrix, rotation_matrix

SHAPES = {  # radius at the narrow end, at the wide end, length (m), mass (kg), sides
    "cone": (0.0, 0.05, 0.05, 0.3, 48),
    "slim cone": (0.0, 0.03, 0.1, 0.2, 48),
    "traffic cone": (0.0, 0.15, 0.6, 3.0, 32),
    "tiny cone": (0.0, 0.01, 0.02, 0.005, 20),
    "cup": (0.03, 0.045, 0.12, 0.2, 64),
    "bucket": (0.1, 0.15, 0.3, 1.0, 100),
}


@dataclass(frozen=True)
class Lying:
    """A body that lies on its side on a plane, with its apex in the origin and its contact line along x.

    Attributes:
        urdf: The body, its centre of mass in the origin, its narrow end along z.
        turn: Its orientation (3×3).
        center: Where its centre of mass is (m).
        inertia: About the contact line ÷ its mass (m²).
    """

    urdf: str
    turn: np.ndarray
    center: np.ndarray
    inertia: float


def lying(folder, what: str) -> Lying:
    narrow, wide, length, mass, sides = SHAPES[what]
    angles = 2 * pi * np.arange(sides) / sides
    rings = [
        np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(sides, z)])
        for radius, z in ((wide, 0.0), (narrow, length))
    ]
    mesh = trimesh.convex.convex_hull(np.vstack(rings) if narrow else np.vstack([rings[0], [[0.0, 0.0, length]]]))
    lower = mesh.center_mass[2]
    mesh.apply_translation(-mesh.center_mass)
    mesh.export(folder / "round.stl")
    moments = np.diag(mesh.moment_inertia) / mesh.volume
    half = atan2(wide - narrow, length)  # the angle of the side from the axis
    apart = wide / (wide - narrow) * length - lower  # of the centre of mass from the apex
    z = -np.array([cos(half), 0.0, sin(half)])
    turn = np.column_stack([np.cross([0.0, 1.0, 0.0], z), [0.0, 1.0, 0.0], z])
    about_line = moments[2] * cos(half) ** 2 + moments[0] * sin(half) ** 2 + (apart * sin(half)) ** 2
    urdf = thing(f'<mesh filename="file://{folder}/round.stl"/>', mass, mass * moments)
    return Lying(urdf, turn, -apart * z, about_line)


def rpy(turn: np.ndarray) -> tuple[float, float, float]:
    matrix = np.eye(4)
    matrix[:3, :3] = turn
    return euler_from_matrix(matrix)


def azimuth(twin, tilt: float = 0.0) -> float:
    """The direction of the wide end in a plane that falls off along x (rad)."""
    axis = -quaternion_matrix(twin.entities.state("thing").orientation)[:3, 2]
    x, y, _ = rotation_matrix(-tilt, (0, 1, 0))[:3, :3] @ axis
    return atan2(y, x)


# A step of Drake's errs by the rate² · step: what rolls in a narrow circle gains speed (docs/physics.md).
@pytest.mark.parametrize("what", ["cone", "tiny cone", "cup", "bucket"])
@every_engine
def test_a_cone_on_its_side_rolls_about_its_apex(figure, tmp_path, engine, what):
    body, rate = lying(tmp_path, what), 0.5
    twin = Scene(tmp_path, engine, plane()).add("thing", body.urdf, body.center, rpy(body.turn)).build()
    twin.advance_to(0.2)
    spin = np.array([-rate * body.center[0] / body.center[2], 0.0, 0.0])
    twin.entities.set_state("thing", linear=tuple(np.cross(spin, position(twin, "thing"))), angular=tuple(spin))
    last, turned = azimuth(twin), 0.0
    for _ in range(60):
        twin.advance_to(twin.time + 0.05)
        now = azimuth(twin)
        turned += (now - last + pi) % (2 * pi) - pi
        last = now
    assert figure("cones on the level: way in 3 s ÷ closed form", turned / (3 * rate)) == pytest.approx(1, abs=0.01)
    kept = np.linalg.norm(twin.entities.state("thing").angular) / np.linalg.norm(spin)
    assert figure("cones on the level: speed kept in 3 s", kept) == pytest.approx(1, abs=0.01)
    assert position(twin, "thing")[2] == pytest.approx(body.center[2], abs=2e-4)
    assert np.hypot(*position(twin, "thing")[:2]) == pytest.approx(body.center[0], abs=2e-3)


@pytest.mark.parametrize("what", SHAPES)
@every_engine
def test_a_cone_on_a_slope_swings_about_its_apex(figure, tmp_path, engine, what):
    tilt, start = radians(10.0), radians(10.0)
    body = lying(tmp_path, what)
    down = rotation_matrix(tilt, (0, 1, 0))[:3, :3] @ rotation_matrix(start, (0, 0, 1))[:3, :3]
    scene = Scene(tmp_path, engine, plane(tilt))
    twin = scene.add("thing", body.urdf, down @ body.center, rpy(down @ body.turn)).build()
    along, _, height = body.center
    rate = sqrt(G * sin(tilt) * along / body.inertia) * height / along * (1 - start**2 / 16)
    passed, last = [], azimuth(twin, tilt)
    while len(passed) < 5:
        twin.advance_to(twin.time + 0.01)
        now = azimuth(twin, tilt)
        if last * now < 0:
            passed.append(twin.time - 0.01 * now / (now - last))
        last = now
        assert twin.time < 20 / rate
    period = float(np.diff(passed).mean()) * 2
    assert figure("cones on 10°: period ÷ closed form", period * rate / (2 * pi)) == pytest.approx(1, abs=0.01)


@pytest.mark.parametrize("sides", [16, 24, 64, 200])
@pytest.mark.parametrize("axis", "xyz")
@every_engine
def test_a_cylinder_of_triangles_rolls(figure, tmp_path, engine, axis, sides):
    radius, length, mass, tilt = 0.05, 0.12, 0.7, radians(10.0)
    mesh = trimesh.creation.cylinder(radius, length, sections=sides)
    turn = {"x": ((0, 1, 0), (0, 0, pi / 2)), "y": ((1, 0, 0), (0, 0, 0)), "z": ((0, 0, 1), (pi / 2, 0, 0))}
    about, pose = turn[axis]
    mesh.apply_transform(rotation_matrix(pi / 2, about))
    mesh.export(tmp_path / "cylinder.stl")
    side, own = mass / 12 * (3 * radius**2 + length**2), mass * radius**2 / 2
    moments = [own if name == axis else side for name in "xyz"]
    urdf = thing(f'<mesh filename="file://{tmp_path}/cylinder.stl"/>', mass, moments)
    twin = Scene(tmp_path, engine, static_box(tilt)).add("thing", urdf, on_slope(tilt, z=radius), pose).build()
    twin.advance_to(0.3)
    before, time = np.linalg.norm(velocity(twin, "thing")), twin.time
    twin.advance_to(1.3)
    acceleration = (np.linalg.norm(velocity(twin, "thing")) - before) / (twin.time - time)
    expected = G * sin(tilt) / 1.5
    assert figure("rolls down 10°: acceleration ÷ closed form", acceleration / expected) == pytest.approx(1, abs=0.01)
    assert asin(min(1.0, abs(float(position(twin, "thing")[1])) / length)) < 0.1
