"""Boxes that slide: friction brakes them by µ·g, and by no more or less, on whatever they slide."""

from math import atan, cos, radians, sin

import numpy as np
import pytest
from scenes import (
    G,
    Scene,
    box,
    every_engine,
    on_slope,
    plane,
    position,
    static_box,
    static_mesh,
    step_error,
    velocity,
)

BOX = (0.2, 0.3, 0.1)
YAW = 0.4
START = 0.2
FRICTIONS = (0.1, 0.2, 0.3, 0.5, 0.8)
SPEEDS = (0.5, 1.0, 3.0)
GROUNDS = ("plane", "box", "mesh", "slab")


def sliding(folder, engine, ground, friction, speed):
    floors = {
        "plane": lambda: plane(friction=friction),
        "box": lambda: static_box(friction=friction),
        "mesh": lambda: static_mesh(folder / "terrain.obj", friction=friction),
        "slab": lambda: plane(friction=100.0),
    }
    scene = Scene(folder, engine, floors[ground]())
    top = 0.0
    if ground == "slab":  # which moves, but is heavy and rough below
        top = 0.1
        scene.add("slab", box((30.0, 4.0, top), 400.0, friction=100.0), (10, 0, top / 2))
    scene.add("crate", box(BOX, friction=friction), (0, 0, top + BOX[2] / 2), (0, 0, YAW))
    twin = scene.build()
    twin.advance_to(START)  # the ground bears it
    twin.entities.set_state("crate", linear=(speed, 0, 0))
    return twin


def check_slide(figure, folder, engine, ground, friction, speed):
    twin = sliding(folder, engine, ground, friction, speed)
    x, stop = position(twin, "crate")[0], speed / (friction * G)
    h = step_error(engine)
    speeds = []
    for time in (max(0.1 * stop, 2 * h), 0.7 * stop):
        twin.advance_to(START + time)
        speeds.append((twin.time, velocity(twin, "crate")[0]))
    (t1, v1), (t2, v2) = speeds
    twin.advance_to(START + 1.3 * stop + 0.3)
    distance = position(twin, "crate")[0] - x
    expected = speed**2 / (2 * friction * G)
    brake = figure(f"slides on a {ground}: deceleration ÷ µ g", (v1 - v2) / (t2 - t1) / (friction * G))
    # A slide of six steps is measured over three of them.
    assert brake == pytest.approx(1.0, abs=0.03 if stop > 10 * h else 0.05)
    figure(f"slides on a {ground}: (distance + v h/2) ÷ v²/(2 µ g)", (distance + speed * h / 2) / expected)
    assert distance == pytest.approx(expected, abs=0.03 * expected + speed * h / 2)
    assert np.linalg.norm(velocity(twin, "crate")) < 1e-3


@every_engine
@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize(("friction", "speed"), [(0.2, 1.0), (0.5, 3.0)])
def test_a_sliding_box_is_braked_by_friction(figure, tmp_path, engine, ground, friction, speed):
    check_slide(figure, tmp_path, engine, ground, friction, speed)


@pytest.mark.slow
@every_engine
@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("speed", SPEEDS)
def test_every_sliding_box_is_braked_by_friction(figure, tmp_path, engine, ground, friction, speed):
    check_slide(figure, tmp_path, engine, ground, friction, speed)


@every_engine
@pytest.mark.parametrize("gap", [0.0, 1e-4, 1e-3])
@pytest.mark.parametrize("ground", ["plane", "box"])
def test_a_box_set_down_on_a_steep_slope_slides_down(figure, tmp_path, engine, gap, ground):
    tilt, friction = radians(30), 0.3
    floor = plane(tilt, friction) if ground == "plane" else static_box(tilt, friction)
    scene = Scene(tmp_path, engine, floor)
    scene.add("crate", box(BOX, friction=friction), on_slope(tilt, z=BOX[2] / 2 + gap), (0, tilt, 0))
    twin = scene.build()
    twin.advance_to(0.3)
    v1 = np.linalg.norm(velocity(twin, "crate"))
    twin.advance_to(1.0)
    v2 = np.linalg.norm(velocity(twin, "crate"))
    ratio = (v2 - v1) / 0.7 / (G * (sin(tilt) - friction * cos(tilt)))
    assert figure("set down on 30°, µ 0.3: acceleration ÷ closed form", ratio) == pytest.approx(1.0, abs=0.03)


@every_engine
@pytest.mark.parametrize("friction", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("ground", ["plane", "box"])
def test_the_angle_of_friction_divides_what_stays_from_what_slides(figure, tmp_path, engine, friction, ground):
    moved = []
    for share in (0.95, 1.05):
        tilt = atan(share * friction)
        floor = plane(tilt, friction) if ground == "plane" else static_box(tilt, friction)
        scene = Scene(tmp_path, engine, floor)
        scene.add("crate", box(BOX, friction=friction), on_slope(tilt, z=BOX[2] / 2), (0, tilt, 0))
        twin = scene.build()
        twin.advance_to(1.0)
        start = position(twin, "crate")
        twin.advance_to(6.0)
        moved.append(np.linalg.norm(position(twin, "crate") - start))
    stays, slides = moved
    assert figure("at 0.95 of the friction angle: way in 5 s (mm)", 1e3 * stays) < 0.2
    tilt = atan(1.05 * friction)
    acceleration = G * (sin(tilt) - friction * cos(tilt))
    ratio = slides / (acceleration * (6**2 - 1**2) / 2)
    assert figure("at 1.05 of the friction angle: way ÷ closed form", ratio) == pytest.approx(1.0, rel=0.4)
