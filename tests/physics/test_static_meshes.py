"""Things on, in and at static meshes, which are as thick as their files say.

Meshes of one connected part that is not convex: a plate on two walls, cups and trays turned on a lathe, stairs. Heights
follow from geometry alone.
"""

import numpy as np
import pytest
import trimesh
from scenes import Scene, box, every_engine, position, sphere, static, velocity

THICKNESSES = (0.002, 0.005, 0.02, 0.04, 0.2)  # m


def extruded(outline, caps, length):
    """A closed mesh: an outline in x and z, counterclockwise, with triangles of its points as caps, long along y."""
    count = len(outline)
    ends = [np.array([(x, y, z) for x, z in outline]) for y in (-length / 2, length / 2)]
    faces = [*caps, *((c + count, b + count, a + count) for a, b, c in caps)]
    for n in range(count):
        m = (n + 1) % count
        faces += [(m, n, n + count), (m, n + count, m + count)]
    mesh = trimesh.Trimesh(np.vstack(ends), faces, process=False)
    assert mesh.is_watertight
    assert mesh.volume > 0
    return mesh


def bridge(thickness, top=0.5):
    """A plate on two walls."""
    low = top - thickness
    outline = [(-0.5, 0), (-0.45, 0), (-0.45, low), (0.45, low), (0.45, 0), (0.5, 0)]
    outline += [(0.5, top), (0.45, top), (-0.45, top), (-0.5, top)]
    left, middle, right = [(0, 1, 2), (0, 2, 9), (2, 8, 9)], [(2, 3, 7), (2, 7, 8)], [(3, 4, 5), (3, 5, 6), (3, 6, 7)]
    return extruded(outline, left + middle + right, 1.0)


def stairs(count=4, tread=0.2, rise=0.1):
    """Solid stairs that lead up along x."""
    outline = [(0, 0), (count * tread, 0)]
    for step in reversed(range(count)):
        outline += [((step + 1) * tread, (step + 1) * rise), (step * tread, (step + 1) * rise)]
    caps = [(0, 1, 2)] + [(0, k, k + 1) for k in range(2, len(outline) - 1)]
    return extruded(outline, caps, 1.0)


def turned(profile, sections):
    """A mesh turned on a lathe: radius and height of its outline."""
    return trimesh.creation.revolve(np.array(profile), sections=sections)


def cup(radius=0.05, height=0.1, wall=0.003):
    outline = [(0, 0), (radius, 0), (radius, height), (radius - wall, height), (radius - wall, wall), (0, wall)]
    return turned(outline, 24)


def tray(side=0.4, height=0.05, wall=0.003):
    half, thick = side / 2**0.5, wall * 2**0.5
    outline = [(0, 0), (half, 0), (half, height), (half - thick, height), (half - thick, wall), (0, wall)]
    mesh = turned(outline, 4)
    mesh.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 4, (0, 0, 1)))
    return mesh


def scene(tmp_path, engine, mesh, pose=(0, 0, 0, 0, 0, 0), **options):
    mesh.export(tmp_path / "mesh.stl")
    return Scene(tmp_path, engine, static(f"<mesh><uri>{tmp_path / 'mesh.stl'}</uri></mesh>", pose), **options)


def settled(twin, until=0.6):
    twin.advance_to(until)
    assert np.linalg.norm(velocity(twin, "thing")) < 1e-3
    return position(twin, "thing")


@pytest.mark.parametrize("thickness", THICKNESSES)
@every_engine
def test_a_crate_stands_on_a_table_at_its_height(tmp_path, engine, thickness):
    twin = scene(tmp_path, engine, bridge(thickness)).add("thing", box((0.1, 0.1, 0.1)), (0.1, 0, 0.5501)).build()
    assert settled(twin) == pytest.approx((0.1, 0, 0.55), abs=2e-4)


@pytest.mark.parametrize("thickness", THICKNESSES)
@every_engine
def test_a_crate_is_pressed_to_a_table_from_below_at_its_height(tmp_path, engine, thickness):
    upside_down = (0, 0, 0.5, np.pi, 0, 0)  # the lower side of the plate is above, between the walls
    height = thickness
    twin = (
        scene(tmp_path, engine, bridge(thickness), upside_down)
        .add("thing", box((0.1, 0.1, 0.1)), (0.1, 0, height + 0.0501))
        .build()
    )
    assert settled(twin) == pytest.approx((0.1, 0, height + 0.05), abs=2e-4)


@every_engine
def test_a_ball_lies_in_a_cup(tmp_path, engine):
    twin = scene(tmp_path, engine, cup()).add("thing", sphere(0.02, 0.1), (0, 0, 0.03)).build()
    assert settled(twin) == pytest.approx((0, 0, 0.003 + 0.02), abs=2e-4)


@every_engine
def test_a_cube_stands_on_a_tray(tmp_path, engine):
    twin = scene(tmp_path, engine, tray()).add("thing", box((0.04, 0.04, 0.04), 0.1), (0.02, 0.01, 0.0231)).build()
    assert settled(twin) == pytest.approx((0.02, 0.01, 0.003 + 0.02), abs=2e-4)


@pytest.mark.parametrize("step", range(4))
@every_engine
def test_a_crate_stands_on_each_stair(tmp_path, engine, step):
    x, z = 0.1 + 0.2 * step, 0.1 * (step + 1) + 0.05
    twin = scene(tmp_path, engine, stairs()).add("thing", box((0.1, 0.1, 0.1)), (x, 0, z + 1e-4)).build()
    assert settled(twin) == pytest.approx((x, 0, z), abs=2e-4)


@pytest.mark.parametrize("wall", [0.002, 0.01])
@every_engine
def test_a_wall_is_not_passed_at_a_meter_a_second(tmp_path, engine, wall):
    crate = box((0.1, 0.1, 0.1), friction=0.1)
    twin = scene(tmp_path, engine, tray(1.0, 0.3, wall)).add("thing", crate, (0, 0, wall + 0.0501)).build()
    twin.advance_to(0.1)
    twin.entities.set_state("thing", linear=(1.5, 0, 0))
    far = 0.0
    while twin.time < 1.5:
        twin.advance_to(twin.time + 0.01)
        far = max(far, position(twin, "thing")[0])
    touching = 0.5 - wall - 0.05
    assert touching - 0.001 < far < touching + 0.01
    assert position(twin, "thing")[0] < touching + 1e-3
