"""Things that spin on the ground: friction brakes them as if their weight were spread evenly over their side."""

from math import pi

import numpy as np
import pytest
import trimesh
from scenes import G, Scene, box, every_engine, plane, thing

FRICTION, SPEED = 0.3, 3.0  # rad/s
BOXES = {"cube": (0.2, 0.2, 0.2), "plank": (0.6, 0.1, 0.04), "tile": (0.3, 0.2, 0.02), "post": (0.1, 0.15, 0.4)}


def mean_distance(mesh):
    """Of the points of a prism's base from its middle (m), by the mean over its triangles' smaller triangles."""
    total = area = 0.0
    below = mesh.face_normals[:, 2] < -0.9
    for triangle in mesh.triangles[below]:
        fine = trimesh.Trimesh(triangle, [(0, 1, 2)])
        for _ in range(6):
            fine = fine.subdivide()
        total += float(np.hypot(*fine.triangles_center[:, :2].T) @ fine.area_faces)
        area += float(fine.area)
    return total / area


def check_spin(folder, engine, urdf, mesh, moment_by_mass):
    scene = Scene(folder, engine, plane(0.0, FRICTION))
    twin = scene.add("thing", urdf, (0, 0, -mesh.bounds[0][2])).build()
    twin.advance_to(0.2)  # it has sunk in
    twin.entities.set_state("thing", angular=(0, 0, SPEED))
    deceleration = FRICTION * G * mean_distance(mesh) / moment_by_mass
    stops = SPEED / deceleration
    speeds, times = [], []
    for share in (0.3, 0.8):
        twin.advance_to(round(0.2 + share * stops, 2))
        times.append(twin.time)
        speeds.append(twin.entities.state("thing").angular[2])
    return (speeds[0] - speeds[1]) / (times[1] - times[0]) / deceleration


# On faces, with longer steps, a force acts in the middle of each of a few facets.
WITHIN = {"1ms": 0.015, "10ms": 0.2, "cenic": 0.2}


@pytest.mark.parametrize("name", BOXES)
@every_engine
def test_a_box_that_spins_is_braked_as_by_an_even_pressure(tmp_path, engine, name):
    size = BOXES[name]
    moment = (size[0] ** 2 + size[1] ** 2) / 12
    found = check_spin(tmp_path, engine, box(size, 1.0, 1.0), trimesh.creation.box(size), moment)
    assert found == pytest.approx(1.0, abs=WITHIN[engine])


@pytest.mark.parametrize("sides", [3, 5, 8])
@pytest.mark.parametrize("stretch", [1.0, 2.5])
def test_a_prism_of_stl_that_spins_is_braked_as_by_an_even_pressure(tmp_path, sides, stretch):
    angles = 2 * pi * np.arange(sides) / sides
    base = np.column_stack([stretch * np.cos(angles), np.sin(angles)])
    mesh = trimesh.convex.convex_hull(
        0.1 * np.vstack([np.pad(base, ((0, 0), (0, 1)), constant_values=z) for z in (-0.5, 0.5)])
    )
    mesh.export(tmp_path / "prism.stl")
    moments = (mesh.moment_inertia / mesh.volume).diagonal()
    urdf = thing(f'<mesh filename="file://{tmp_path}/prism.stl"/>', 1.0, moments, 1.0)
    assert check_spin(tmp_path, "1ms", urdf, mesh, moments[2]) == pytest.approx(1.0, abs=WITHIN["1ms"])
