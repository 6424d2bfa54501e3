"""gz-sim's Buoyancy beside Archimedes: draughts, periods, stability, layers and shapes."""

from math import pi, sqrt

import numpy as np
import pytest
from waters import SEA, WATER, G, box, buoyancy, height, layers, period_of, roll, sampled, twin_of

from drake_twin.scenario import Robot
from drake_twin.twin.recording import Recording
from drake_twin.twin.replay import replay

STEPS = (0.001, 0.01)
SIZE = (0.6, 1.0, 0.3)


@pytest.fixture(params=STEPS, ids="{:g} s".format)
def step(request):
    return request.param


@pytest.mark.parametrize("density", [250.0, 700.0])
def test_a_box_floats_at_its_draught_and_heaves_about_it_with_its_period(tmp_path, step, density):
    draught = SIZE[2] * density / WATER
    level = SIZE[2] / 2 - draught
    still, moved = (
        box("still", SIZE, density, f"5 0 {level} 0 0 0"),
        box("box", SIZE, density, f"0 0 {level + 0.02} 0 0 0"),
    )
    twin = twin_of(tmp_path, SEA + still + moved, step)
    times, heights = sampled(twin, lambda: height(twin, "box"), 2.5)
    assert height(twin, "still") == pytest.approx(level, abs=1e-6)
    assert period_of(times, heights - level) == pytest.approx(2 * pi * sqrt(draught / G), rel=0.01)
    assert np.abs(heights - level).max() == pytest.approx(0.02, rel=0.03)  # no energy is gained or lost


def metacentric_height(size, density, low=0.0):
    draught = size[2] * density / WATER
    return draught / 2 + size[1] ** 2 / (12 * draught) - size[2] / 2 + low


def test_a_wide_box_rolls_with_the_period_of_its_metacentric_height(tmp_path, step):
    level = SIZE[2] / 2 - SIZE[2] * 0.5
    twin = twin_of(tmp_path, SEA + box("box", SIZE, 500.0, f"0 0 {level} 0.03 0 0"), step)
    times, angles = sampled(twin, lambda: roll(twin, "box"), 2.5)
    inertia = (SIZE[1] ** 2 + SIZE[2] ** 2) / 12
    assert period_of(times, angles) == pytest.approx(
        2 * pi * sqrt(inertia / G / metacentric_height(SIZE, 500.0)), rel=0.01
    )
    assert np.abs(angles).max() == pytest.approx(0.03, rel=0.03)


@pytest.mark.parametrize(("width", "capsizes"), [(0.26, False), (0.23, True)])
def test_a_box_capsizes_where_its_metacenter_is_below_its_center_of_mass(tmp_path, step, width, capsizes):
    """Half as heavy as water, it stands where its width is more than √(3/2) of its height: 0.245 m here."""
    size = (1.0, width, 0.2)
    assert (metacentric_height(size, 500.0) < 0) == capsizes
    twin = twin_of(tmp_path, SEA + box("box", size, 500.0, "0 0 0 0.01 0 0"), step)
    _, angles = sampled(twin, lambda: roll(twin, "box"), 4.0)
    assert (np.abs(angles).max() > 0.2) == capsizes


def test_a_low_center_of_mass_rights_what_would_capsize(tmp_path, step):
    size = (1.0, 0.1, 0.2)
    twin = twin_of(tmp_path, SEA + box("box", size, 500.0, "0 0 0 0.01 0 0", low=0.08), step)
    times, angles = sampled(twin, lambda: roll(twin, "box"), 2.5)
    assert np.abs(angles).max() < 0.02
    # The waterplane does not move for a roll about the center of mass, to first order; the moment is m g GM.
    inertia = (size[1] ** 2 + size[2] ** 2) / 12
    arm = metacentric_height(size, 500.0, 0.08)
    assert period_of(times, angles) == pytest.approx(2 * pi * sqrt(inertia / (G * arm)), rel=0.01)


def test_a_sphere_floats_with_the_cap_that_archimedes_asks_for(tmp_path, step):
    """A sphere of radius R that is immersed by h displaces π h² (3 R - h) / 3."""
    radius, immersed = 0.25, 0.16
    mass = WATER * pi * immersed**2 * (3 * radius - immersed) / 3
    shape = f"<sphere><radius>{radius}</radius></sphere>"
    body = SEA
    for name, x, up in (("still", 5, 0.0), ("ball", 0, 0.01)):
        pose = f"{x} 0 {radius - immersed + up} 0.3 0.5 0"
        body += box(name, SIZE, pose=pose, mass=mass, collisions=shape)
    twin = twin_of(tmp_path, body, step)
    times, heights = sampled(twin, lambda: height(twin, "ball"), 2.5)
    assert height(twin, "still") == pytest.approx(radius - immersed, abs=1e-6)
    area = pi * (2 * radius * immersed - immersed**2)
    assert period_of(times, heights - heights.mean()) == pytest.approx(
        2 * pi * sqrt(mass / (WATER * G * area)), rel=0.01
    )


def test_what_is_as_dense_as_water_stays_and_what_is_lighter_rises(tmp_path, step):
    body = buoyancy() + box("same", SIZE, WATER, "0 0 -5 0.4 0.3 0.2") + box("light", SIZE, 800.0, "3 0 -9 0 0 0")
    twin = twin_of(tmp_path, body, step)
    twin.advance_to(1.0)
    assert height(twin, "same") == pytest.approx(-5, abs=1e-9)
    assert roll(twin, "same") == pytest.approx(0.4, abs=1e-9)
    assert twin.entities.state("light").linear[2] == pytest.approx(G * (WATER / 800.0 - 1), rel=1e-6)


def test_a_submerged_body_swings_about_its_center_of_volume(tmp_path, step):
    """Neutrally buoyant with its mass lower by d, it turns about its center of mass: ω² = m g d / I."""
    low, size = 0.05, (0.4, 0.4, 0.4)
    twin = twin_of(tmp_path, buoyancy() + box("box", size, WATER, "0 0 -5 0.03 0 0", low=low), step)
    times, angles = sampled(twin, lambda: roll(twin, "box"), 6.0)
    inertia = (size[1] ** 2 + size[2] ** 2) / 12
    assert period_of(times, angles) == pytest.approx(2 * pi * sqrt(inertia / (G * low)), rel=0.01)


def test_a_body_floats_between_two_fluids(tmp_path, step):
    """Of 850 kg/m³ between water and oil of 700: half of it in each, and the surface of the oil far above."""
    fluids = layers((0.0, 700.0), (2.0, 1.2))
    twin = twin_of(tmp_path, fluids + box("box", SIZE, 850.0) + box("up", SIZE, 850.0, "4 0 0.02 0 0 0"), step)
    times, heights = sampled(twin, lambda: height(twin, "up"), 4.5)
    assert height(twin, "box") == pytest.approx(0, abs=1e-6)
    assert period_of(times, heights) == pytest.approx(2 * pi * sqrt(850.0 * SIZE[2] / (300.0 * G)), rel=0.01)


@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        ("<cylinder><radius>0.2</radius><length>0.5</length></cylinder>", pi * 0.2**2 * 0.5),
        ("<capsule><radius>0.2</radius><length>0.5</length></capsule>", pi * 0.2**2 * (0.5 + 0.8 / 3)),
        ("<ellipsoid><radii>0.2 0.3 0.1</radii></ellipsoid>", 4 / 3 * pi * 0.006),
        ("<cone><radius>0.2</radius><length>0.6</length></cone>", pi * 0.2**2 * 0.2),
    ],
    ids=lambda value: value.partition(">")[0][1:] if isinstance(value, str) else "",
)
def test_each_shape_displaces_its_volume(tmp_path, shape, volume):
    body = layers((0.0, 1.2)) + box("deep", SIZE, pose="0 0 -9 0 0 0", mass=100.0, collisions=shape)
    twin = twin_of(tmp_path, body, 0.001)
    twin.advance_to(0.1)
    assert twin.entities.state("deep").linear[2] / 0.1 == pytest.approx(volume * WATER * G / 100.0 - G, rel=5e-3)


def _angle(folder):
    """An OBJ of a closed angle of two arms: not convex, and its volume is 0.75 of that of the box around it."""
    outline = [(0, 0), (1, 0), (1, 0.5), (0.5, 0.5), (0.5, 1), (0, 1)]
    corners = [(x, y, z) for z in (0, 1) for x, y in outline]
    caps = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    faces = [(a, c, b) for a, b, c in caps] + [(a + 6, b + 6, c + 6) for a, b, c in caps]
    for a in range(6):
        b = (a + 1) % 6
        faces += [(a, b, b + 6), (a, b + 6, a + 6)]
    lines = ["v {} {} {}".format(*corner) for corner in corners]
    lines += ["f {} {} {}".format(*(number + 1 for number in face)) for face in faces]
    (folder / "angle.obj").write_text("\n".join(lines) + "\n")
    return f"<mesh><uri>{folder / 'angle.obj'}</uri></mesh>"


def test_a_closed_mesh_displaces_its_own_volume_and_not_that_of_its_hull(tmp_path):
    twin = twin_of(tmp_path, buoyancy() + box("angle", SIZE, mass=1000.0, collisions=_angle(tmp_path)), 0.001)
    twin.advance_to(0.01)
    assert twin.entities.state("angle").linear[2] / 0.01 == pytest.approx(-0.25 * G, rel=1e-3)


@pytest.mark.parametrize(
    ("enable", "floats"),
    [("", "one two"), ("one", "one"), ("two::hull", "two"), ("hull", ""), ("on", ""), ("one two", "one two")],
)
def test_only_what_is_enabled_floats(tmp_path, enable, floats):
    own = "".join(f"<enable>{name}</enable>" for name in enable.split())
    body = buoyancy(f"<uniform_fluid_density>1000</uniform_fluid_density>{own}")
    body += box("one", SIZE, WATER) + box("two", SIZE, WATER, "3 0 0 0 0 0")
    twin = twin_of(tmp_path, body, 0.01)
    twin.advance_to(0.1)
    assert [name for name in ("one", "two") if height(twin, name) > -1e-6] == floats.split()


def test_a_robot_that_is_spawned_later_floats_too(tmp_path):
    twin = twin_of(tmp_path, buoyancy(), 0.001)
    file = tmp_path / "buoy.sdf"
    file.write_text(f'<sdf version="1.9">{box("buoy", SIZE, 500.0)}</sdf>')
    twin.advance_to(0.1)
    twin.entities.spawn(Robot("buoy", str(file), xyz=(0, 0, -5)))
    twin.advance_to(0.3)
    assert twin.entities.state("buoy").linear[2] == pytest.approx(0.2 * G, rel=1e-6)


def test_a_replay_and_a_restored_twin_repeat_the_motion_to_the_last_bit(tmp_path):
    twin = twin_of(tmp_path, SEA + box("box", SIZE, 400.0, "0 0 0.1 0.3 0.2 0"), 0.001)
    twin.recorder.begin()
    twin.advance_to(0.2)
    snapshot = twin.snapshot()
    twin.advance_to(0.4)
    end = twin.state_sha256()
    twin.recorder.recording().save(tmp_path / "run.json")
    twin.restore(snapshot)
    twin.advance_to(0.4)
    assert twin.state_sha256() == end
    assert replay(Recording.load(tmp_path / "run.json")).state_sha256() == end
