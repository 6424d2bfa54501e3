"""gz-sim's BuoyancyEngine beside mechanics: a body that rises and dives by the volume of its bladder."""

from math import sqrt, tanh

import pytest
from waters import WATER, G, bladder, box, buoyancy, hydrodynamics, twin_of

from drake_twin.messages.interface_types import make

SIZE = (1.0, 0.4, 0.3)
MASS = 0.12 * WATER
TOPIC = "/auv/buoyancy_engine"
ENGINE = {"namespace": "sub", "min_volume": 0, "max_volume": 0.01, "neutral_volume": 0.002, "default_volume": 0.002}


@pytest.fixture(params=(0.001, 0.01), ids="{:g} s".format)
def step(request):
    return request.param


def glider(folder, step, *plugins, height=-20.0, **elements):
    """A box as heavy as its water, with a bladder of 2 l that is as heavy as it lifts."""
    text = box("auv", SIZE, WATER, more=bladder(**(ENGINE | elements)) + "".join(plugins))
    return twin_of(folder, buoyancy(), step, {"auv": (text, (0, 0, height))})


def ask(twin, volume):
    twin.publish(TOPIC, make("std_msgs/msg/Float64", {"data": volume}))


def motion(twin):
    state = twin.entities.state("auv")
    return state.position[2], state.linear[2]


def test_it_hovers_at_its_neutral_volume(tmp_path, step):
    twin = glider(tmp_path, step)
    twin.advance_to(2.0)
    assert motion(twin) == pytest.approx((-20.0, 0.0), abs=1e-9)


@pytest.mark.parametrize("volume", [0.005, 0.0005])
def test_the_pump_changes_the_force_evenly_until_the_volume_is_there(tmp_path, step, volume):
    """m v' = ρ g r t: v = ρ g r t² / 2m until t₁ = ΔV / r, then evenly; the topic has the volume."""
    rate = 0.003
    twin = glider(tmp_path, step, max_inflation_rate=rate)
    heard = []
    twin.subscribe(f"{TOPIC}/current_volume", lambda message: heard.append((twin.time, message.data)))
    ask(twin, volume)
    sign, filled = (1 if volume > 0.002 else -1), abs(volume - 0.002) / rate
    half, full = filled / 2, filled + 0.5
    twin.advance_to(round(half, 9))
    push = WATER * G * rate / (2 * MASS)
    assert motion(twin)[1] == pytest.approx(sign * push * half**2, rel=1e-3)
    twin.advance_to(round(full, 9))
    assert motion(twin)[1] == pytest.approx(sign * push * (filled**2 + 2 * filled * 0.5), rel=1e-3)
    for time, value in heard:
        assert value == pytest.approx(0.002 + sign * rate * min(time, filled), rel=1e-9)


def test_it_rises_at_the_speed_at_which_the_water_holds_it(tmp_path, step):
    """(m + mₐ) v' = F - D v²: v = s tanh(D s t / (m + mₐ)), s² = F / D, from a pump of no time."""
    water = hydrodynamics(zWabsW=-3000, zDotW=-80)
    twin = glider(tmp_path, step, water, max_inflation_rate=1e3)
    ask(twin, 0.006)
    force, damping = WATER * G * 0.004, 3000.0
    steady = sqrt(force / damping)
    for time in (0.2, 0.6, 2.0):
        twin.advance_to(time)
        assert motion(twin)[1] == pytest.approx(steady * tanh(damping * steady * time / (MASS + 80)), rel=5e-3)


def test_above_the_surface_it_has_its_weight_alone(tmp_path, step):
    twin = glider(tmp_path, step, surface=-25.0)
    twin.advance_to(0.5)
    assert motion(twin)[1] == pytest.approx(-WATER * 0.002 * G / MASS * 0.5, rel=1e-3)


def test_its_force_is_at_the_links_origin_and_turns_with_gravity(tmp_path, step):
    """A link whose center of mass is 0.1 m above its origin, upside down: the force tilts it neither way."""
    text = box("auv", SIZE, WATER, low=-0.1, more=bladder(**(ENGINE | {"default_volume": 0.01})))
    twin = twin_of(tmp_path, "<gravity>0 -9.8 0</gravity>", step, {"auv": (text, (0, 0, 0))})
    twin.advance_to(0.1)
    state = twin.entities.state("auv")
    moment = WATER * 0.008 * G * 0.1
    inertia = MASS / 12 * (SIZE[1] ** 2 + SIZE[2] ** 2)
    assert state.angular == pytest.approx((moment / inertia * 0.1, 0, 0), rel=1e-2, abs=1e-9)
