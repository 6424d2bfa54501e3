"""What lies, stays: stacks, slopes, robots on their bellies; what falls, comes to rest; what is sunk in, comes out."""

from math import radians

import numpy as np
import pytest
from scenes import (
    Scene,
    box,
    cylinder,
    every_engine,
    farthest_from,
    on_slope,
    plane,
    position,
    sphere,
    static_box,
    static_mesh,
    thing,
    velocity,
)

SLOPE = radians(12.0)
CRATE = (0.2, 0.2, 0.2)


def floor(folder, ground, tilt):
    return {
        "plane": lambda: plane(tilt),
        "box": lambda: static_box(tilt),
        "mesh": lambda: static_mesh(folder / "terrain.obj", tilt),
    }[ground]()


def bowl(folder):
    """A mesh in the form of a bowl with a flat foot; its hull is what touches."""
    turns = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    rings = [(0.06, 0.0), (0.10, 0.03), (0.12, 0.08)]
    lines = [f"v {r * np.cos(t)} {r * np.sin(t)} {z}" for r, z in rings for t in turns]
    faces = ["f " + " ".join(str(index + 1) for index in range(23, -1, -1))]
    for ring in range(2):
        for k in range(24):
            a, b = 24 * ring + k + 1, 24 * ring + (k + 1) % 24 + 1
            faces.append(f"f {a} {b} {b + 24} {a + 24}")
    file = folder / "bowl.obj"
    file.write_text("\n".join(lines + faces))
    return file


def lying(folder, what):
    """URDF of a thing, and the height of its frame above what it stands on (m)."""
    if what == "box":
        return box((0.2, 0.3, 0.1), 2.0), 0.05
    if what == "cylinder":
        return cylinder(0.05, 0.12, 0.8), 0.06

    mesh = f'<mesh filename="file://{bowl(folder)}"/>'
    return thing(mesh, 0.5, (1e-3, 1e-3, 1e-3), center=(0, 0, 0.04)), 0.0


def check_rest(figure, folder, engine, ground, tilt, what, seconds):
    urdf, height = lying(folder, what)
    scene = Scene(folder, engine, floor(folder, ground, tilt))
    scene.add("thing", urdf, on_slope(tilt, 0.3, 0.2, height + 1e-4), (0, tilt, 0))
    twin = scene.build()
    twin.advance_to(5.0)
    moved = farthest_from(twin, "thing", position(twin, "thing"), 5.0 + seconds)
    assert figure(f"{what} at rest for {seconds:.0f} s: moves (mm)", 1e3 * moved) < 1.0


@every_engine
@pytest.mark.parametrize("what", ["box", "cylinder", "bowl"])
@pytest.mark.parametrize(("ground", "tilt"), [("plane", 0.0), ("box", SLOPE), ("mesh", SLOPE)])
def test_what_lies_stays(figure, tmp_path, engine, ground, tilt, what):
    check_rest(figure, tmp_path, engine, ground, tilt, what, 5.0)


@pytest.mark.slow
@every_engine
@pytest.mark.parametrize("what", ["box", "cylinder", "bowl"])
@pytest.mark.parametrize("ground", ["plane", "box", "mesh"])
@pytest.mark.parametrize("tilt", [0.0, SLOPE])
def test_what_lies_stays_for_a_minute(figure, tmp_path, engine, ground, tilt, what):
    check_rest(figure, tmp_path, engine, ground, tilt, what, 60.0)


def check_stack(figure, folder, engine, count, tilt, seconds, bound, ground="box"):
    scene = Scene(folder, engine, floor(folder, ground, tilt))
    for index in range(count):
        scene.add(f"crate_{index}", box(CRATE), on_slope(tilt, z=0.1 + 0.2 * index + 1e-4), (0, tilt, 0))
    twin = scene.build()
    twin.advance_to(5.0)
    settled = [position(twin, f"crate_{index}") for index in range(count)]
    twin.advance_to(5.0 + seconds)
    moved = [np.linalg.norm(position(twin, f"crate_{index}") - settled[index]) for index in range(count)]
    where = "level" if tilt == 0 else "12°"
    assert figure(f"{count} crates, {where}, {seconds:.0f} s: move (mm)", 1e3 * max(moved)) < 1e3 * bound
    expected = on_slope(tilt, z=0.2 * count - 0.1)
    assert np.linalg.norm(position(twin, f"crate_{count - 1}") - expected) < 0.01


@every_engine
def test_five_crates_stand_on_each_other(figure, tmp_path, engine):
    check_stack(figure, tmp_path, engine, 5, 0.0, 2.0, 1e-3, "plane")


@every_engine
def test_three_crates_stand_on_each_other_on_a_slope(figure, tmp_path, engine):
    check_stack(figure, tmp_path, engine, 3, SLOPE, 2.0, 2e-3)


@pytest.mark.slow
@every_engine
@pytest.mark.parametrize(("count", "tilt", "bound"), [(5, 0.0, 1e-3), (3, SLOPE, 2e-3)])
@pytest.mark.parametrize("ground", ["plane", "box", "mesh"])
def test_stacks_stand_for_a_minute(figure, tmp_path, engine, count, tilt, bound, ground):
    check_stack(figure, tmp_path, engine, count, tilt, 60.0, bound, ground)


@every_engine
def test_a_box_stays_on_a_robot_that_lies_on_a_slope(figure, tmp_path, engine):
    scene = Scene(tmp_path, engine, static_box(SLOPE))
    scene.add("robot", box((0.6, 0.4, 0.2), 12.0), on_slope(SLOPE, z=0.1), (0, SLOPE, 0))
    scene.add("crate", box(CRATE), on_slope(SLOPE, 0.1, 0.05, 0.3 + 1e-4), (0, SLOPE, 0.0))
    twin = scene.build()
    twin.advance_to(5.0)
    moved = farthest_from(twin, "crate", position(twin, "crate"), 10.0)
    assert figure("crate on a robot at 12°, 5 s: moves (mm)", 1e3 * moved) < 1.0


DROPPED = {
    "box": (box((0.2, 0.3, 0.1)), 0.05),
    "cube": (box(CRATE, 8.0), 0.1),
    "cylinder": (cylinder(0.05, 0.12), 0.06),
    "ball": (sphere(0.1), 0.1),
}


@every_engine
@pytest.mark.parametrize("what", DROPPED)
def test_what_falls_neither_bounces_nor_sinks_in(figure, tmp_path, engine, what):
    urdf, height = DROPPED[what]
    twin = Scene(tmp_path, engine).add("thing", urdf, (0, 0, 1.0 + height)).build()
    impact = (2 / 9.81) ** 0.5
    twin.advance_to(impact + 0.02)
    rebound, depth = 0.0, 0.0
    while twin.time < impact + 1.0:
        twin.step()
        z = position(twin, "thing")[2] - height
        rebound = max(rebound, z)
        if twin.time > impact + 0.3:
            depth = max(depth, -z)
    assert figure("dropped from 1 m: rebound (mm)", 1e3 * rebound) < 5
    assert figure("dropped from 1 m: depth after 0.3 s (mm)", 1e3 * depth) < 2


@every_engine
@pytest.mark.parametrize("what", ["cube", "box", "cylinder", "ball"])
def test_what_is_sunk_in_comes_out_without_a_jump(figure, tmp_path, engine, what):
    urdf, height = DROPPED[what]
    twin = Scene(tmp_path, engine).add("thing", urdf, (0, 0, height - 0.05)).build()
    heights = {}
    while twin.time < 2.0:
        twin.step()
        heights[round(twin.time, 3)] = position(twin, "thing")[2] - height
    assert figure("5 cm deep: height after 0.5 s (mm)", 1e3 * heights[0.5]) > -2
    assert abs(figure("5 cm deep: height after 1 s (mm)", 1e3 * heights[1.0])) < 2
    assert figure("5 cm deep: highest (mm)", 1e3 * max(heights.values())) < 20
    assert np.linalg.norm(velocity(twin, "thing")) < 1e-3


def wedge(folder):
    """A mesh whose foot is two triangles: a block with a ridge."""
    points = [(x, y, 0.0) for x in (-0.2, 0.2) for y in (-0.15, 0.15)]
    points += [(x, y, 0.2) for x in (-0.2, 0.2) for y in (-0.15, 0.15)] + [(0, 0, 0.25)]
    faces = ["1 2 4 3", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4", "5 7 9", "7 8 9", "8 6 9", "6 5 9"]
    file = folder / "wedge.obj"
    file.write_text("\n".join([*(f"v {x} {y} {z}" for x, y, z in points), *(f"f {face}" for face in faces)]))
    return f'<mesh filename="file://{file}"/>'


@every_engine
def test_a_hull_of_few_triangles_does_not_rock(tmp_path, engine):
    urdf = thing(wedge(tmp_path), 40.0, (2.0, 2.0, 1.5), center=(0.04, 0.0, 0.4))
    twin = Scene(tmp_path, engine).add("thing", urdf, (0, 0, 1e-3), (0.004, 0.002, 0)).build()
    twin.advance_to(3.0)
    assert np.linalg.norm(twin.entities.state("thing").angular) < 1e-4
    assert farthest_from(twin, "thing", position(twin, "thing"), 5.0) < 1e-4
    assert abs(position(twin, "thing")[2]) < 1e-4
