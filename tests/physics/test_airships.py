"""gz-sim's LighterThanAirDynamics beside mechanics: drag along and across a hull, and the air that moves with it."""

from math import cos, sqrt

import numpy as np
import pytest
from repeated_runs import goes_on_to_the_same_bits
from waters import box, twin_of

STEPS = (0.001, 0.01)
SIZE = (3.0, 1.0, 1.0)
MASS = 6.0
AIR = 1.2
COEFFICIENTS = (
    *("force_inviscid_coeff", "force_viscous_coeff", "moment_inviscid_coeff", "moment_viscous_coeff"),
    "axial_drag_coeff",
)


@pytest.fixture(params=STEPS, ids="{:g} s".format)
def step(request):
    return request.param


def hull(added, **coefficients):
    """SDF of a box as a hull with added mass and gz-sim's LighterThanAirDynamics."""
    values = {"link_name": "hull", "air_density": AIR, "eps_v": 0.0, **dict.fromkeys(COEFFICIENTS, 0.0), **coefficients}
    own = "".join(f"<{tag}>{value}</{tag}>" for tag, value in values.items())
    name = "gz::sim::systems::LighterThanAirDynamics"
    plugin = f'<plugin filename="gz-sim-lighter_than_air_dynamics-system" name="{name}">{own}</plugin>'
    fluid = "".join(f"<{tag}>{value}</{tag}>" for tag, value in added.items())
    text = box("blimp", SIZE, mass=MASS, more=plugin)
    return text.replace("</inertial>", f"<fluid_added_mass>{fluid}</fluid_added_mass></inertial>", 1)


def airship(folder, step, *arguments, **named):
    text = hull(*arguments, **named)
    return twin_of(folder, "<gravity>0 0 0</gravity>", step, {"blimp": (text, (0, 0, 0))})


def velocity(twin):
    return np.array(twin.entities.state("blimp").linear)


@pytest.mark.parametrize("start", [2.0, -2.0])
def test_drag_along_the_hull_brakes_it_with_the_air_that_it_carries(tmp_path, step, start):
    twin = airship(tmp_path, step, {"xx": 3.0}, axial_drag_coeff=5.0)
    twin.entities.set_state("blimp", linear=(start, 0, 0))
    twin.advance_to(1.0)
    rate = AIR / 2 * 5.0 / (MASS + 3.0)
    assert velocity(twin) == pytest.approx((start / (1 + rate * 2.0), 0, 0), rel=1e-3, abs=1e-9)


@pytest.mark.parametrize("place", [1, 2])
def test_viscous_flow_brakes_it_across(tmp_path, step, place):
    twin = airship(tmp_path, step, {"yy": 2.0, "zz": 2.0}, force_viscous_coeff=8.0)
    twin.entities.set_state("blimp", linear=tuple(np.eye(3)[place]))
    twin.advance_to(1.0)
    rate = AIR / 2 * 8.0 / (MASS + 2.0)
    assert velocity(twin) == pytest.approx(np.eye(3)[place] / (1 + rate), rel=1e-3, abs=1e-9)


def test_drag_of_any_size_stops_it_and_never_turns_it_round(tmp_path, step):
    twin = airship(tmp_path, step, {}, axial_drag_coeff=1e7, force_viscous_coeff=1e7)
    twin.entities.set_state("blimp", linear=(1.0, 1.0, 0))
    twin.advance_to(0.1)
    assert (velocity(twin) > -1e-6).all()
    assert (velocity(twin) < 0.1).all()


def test_a_push_moves_the_air_with_the_hull(tmp_path, step):
    twin = airship(tmp_path, step, {"xx": 1.0, "yy": 6.0, "zz": 18.0})
    twin.entities.apply_wrench("blimp", force=(6.0, 6.0, 6.0), duration=0.1)
    twin.advance_to(0.5)
    assert velocity(twin) == pytest.approx(0.6 / (MASS + np.array([1.0, 6.0, 18.0])), rel=0.01)


def test_hull_and_air_keep_their_momentum_where_the_air_weighs_the_same_on_all_sides(tmp_path):
    twin = airship(tmp_path, 0.001, {"xx": 4.0, "yy": 4.0, "zz": 4.0, "qq": 1.0})
    twin.entities.set_state("blimp", linear=(0.4, -0.2, 0.3), angular=(0.5, 0.9, -0.7))
    twin.advance_to(2.0)
    assert velocity(twin) == pytest.approx((0.4, -0.2, 0.3), rel=0.01)


def test_added_mass_alone_does_not_turn_a_hull_that_moves_askew(tmp_path):
    """Munk's moment is that of potential flow, and must not act twice."""
    twin = airship(tmp_path, 0.001, {"xx": 1.0, "yy": 6.0, "zz": 6.0})
    twin.entities.set_state("blimp", linear=(2.0, 1.0, 0.5))
    twin.advance_to(0.5)
    assert twin.entities.state("blimp").angular == pytest.approx((0, 0, 0), abs=1e-9)
    assert velocity(twin) == pytest.approx((2.0, 1.0, 0.5))


def test_the_moment_of_potential_flow_turns_a_hull_that_moves_askew(tmp_path, step):
    """Of a positive coefficient towards the motion, which keeps its direction: γ'' = -ω² γ, ω² = ρ V² C / I."""
    coefficient, speed, angle = 0.8, 3.0, 1e-3
    twin = airship(tmp_path, step, {}, moment_inviscid_coeff=coefficient)
    twin.entities.set_state("blimp", linear=(speed * np.cos(angle), speed * np.sin(angle), 0))
    inertia = MASS / 12 * (SIZE[0] ** 2 + SIZE[1] ** 2)
    rate = sqrt(AIR * speed**2 * coefficient / inertia)
    twin.advance_to(1.0)
    w, _, _, z = twin.entities.state("blimp").orientation
    assert 2 * np.arctan2(z, w) == pytest.approx(angle * (1 - cos(rate)), rel=0.01)


def test_a_replay_and_a_restored_twin_repeat_the_motion_to_the_last_bit(tmp_path):
    named = {"axial_drag_coeff": 1.0, "force_viscous_coeff": 2.0, "moment_inviscid_coeff": 0.3, "eps_v": 0.7}
    twin = airship(tmp_path, 0.01, {"xx": 1.0, "yy": 6.0, "yr": 0.3}, **named)
    twin.entities.set_state("blimp", linear=(1, 0.2, 0.1), angular=(0, 0.1, 0.2))
    twin.recorder.begin()
    goes_on_to_the_same_bits(twin, tmp_path)
