"""Loose cylinders, coins, hoops and balls roll as mechanics says: without loss on the level, and down slopes."""

from math import pi, radians, sin

import numpy as np
import pytest
from scenes import G, Scene, every_engine, on_slope, plane, position, sphere, static_box, thing, velocity

GROUNDS = {"plane": plane, "box": static_box}


def roller(what):
    """URDF, radius (m) and moment of inertia about the axis ÷ m r²."""
    if what == "ball":
        return sphere(0.05, 0.5), 0.05, 0.4
    radius, length, mass, share = {
        "cylinder": (0.05, 0.2, 1.0, 0.5),
        "log": (0.15, 2.0, 80.0, 0.5),
        "can": (0.033, 0.12, 0.35, 0.5),
        "coin": (0.0116, 0.0023, 0.0075, 0.5),
        "hoop": (0.3, 0.04, 0.6, 1.0),
    }[what]
    side = mass * (share * radius**2 / 2 + length**2 / 12)
    shape = f'<cylinder radius="{radius}" length="{length}"/>'
    return thing(shape, mass, (side, side, share * mass * radius**2)), radius, share


@pytest.mark.parametrize("what", ["cylinder", "log", "can", "coin", "hoop", "ball"])
@pytest.mark.parametrize("ground", GROUNDS)
@every_engine
def test_what_rolls_keeps_its_speed(figure, tmp_path, engine, ground, what):
    urdf, radius, _ = roller(what)
    twin = Scene(tmp_path, engine, GROUNDS[ground]()).add("thing", urdf, (0, 0, radius), (pi / 2, 0, 0)).build()
    twin.advance_to(0.2)
    twin.entities.set_state("thing", linear=(0.5, 0, 0), angular=(0, 0.5 / radius, 0))
    twin.advance_to(3.2)
    assert figure("rolls on the level: speed kept in 3 s", velocity(twin, "thing")[0] / 0.5) == pytest.approx(
        1, abs=0.01
    )
    assert position(twin, "thing")[2] == pytest.approx(radius, abs=1e-4)
    assert abs(position(twin, "thing")[1]) < 0.01


@pytest.mark.parametrize("what", ["cylinder", "log", "can", "coin", "hoop", "ball"])
@pytest.mark.parametrize("ground", GROUNDS)
@every_engine
def test_what_rolls_down_a_slope_has_its_acceleration(figure, tmp_path, engine, ground, what):
    tilt = radians(10.0)
    urdf, radius, share = roller(what)
    scene = Scene(tmp_path, engine, GROUNDS[ground](tilt)).add("thing", urdf, on_slope(tilt, z=radius), (pi / 2, 0, 0))
    twin = scene.build()
    twin.advance_to(0.3)
    start, time = np.linalg.norm(velocity(twin, "thing")), twin.time
    twin.advance_to(1.3)
    acceleration = (np.linalg.norm(velocity(twin, "thing")) - start) / (twin.time - time)
    expected = G * sin(tilt) / (1 + share)
    assert figure("rolls down 10°: acceleration ÷ closed form", acceleration / expected) == pytest.approx(1, abs=0.01)


@pytest.mark.parametrize("what", ["cylinder", "log", "can", "coin"])
@every_engine
def test_a_cylinder_stands_on_its_end(tmp_path, engine, what):
    urdf, *_ = roller(what)
    length = {"cylinder": 0.2, "log": 2.0, "can": 0.12, "coin": 0.0023}[what]
    twin = Scene(tmp_path, engine, plane()).add("thing", urdf, (0, 0, length / 2 + 1e-5), (0, radians(0.1), 0)).build()
    twin.advance_to(3.0)
    assert position(twin, "thing")[2] == pytest.approx(length / 2, abs=1e-4)
    w, x, y, _ = twin.entities.state("thing").orientation
    assert 2 * np.hypot(x, y) / abs(w) < radians(0.1)
