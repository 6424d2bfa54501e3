"""Hydrodynamic coefficients as arrays: their names, the damping and its slope, and momentum."""

import numpy as np
import pytest

from drake_twin.control.fossen import Damping, coefficients_of, coriolis

U, V, P, R = 3, 4, 0, 2


def damping(velocity, **named):
    wrench, slope = Damping([coefficients_of(named)]).calc(np.array([velocity]))
    return wrench[0], slope[0]


@pytest.mark.parametrize(
    ("name", "wrench"),
    [
        ("xU", {3: 10 * 2.0}),
        ("nV", {2: 10 * -3.0}),
        ("xUabsU", {3: 10 * 4.0}),
        ("yVabsV", {4: 10 * -9.0}),
        ("yVabsU", {4: 10 * -6.0}),
        ("yUabsV", {4: 10 * 6.0}),
        ("yVV", {4: 10 * 9.0}),
        ("kPR", {0: 10 * 0.5 * 0.7}),
        ("xDotU", {}),
    ],
)
def test_each_name_is_its_term(name, wrench):
    velocity = np.zeros(6)
    velocity[[U, V, P, R]] = 2.0, -3.0, 0.5, 0.7
    expected = np.zeros(6)
    expected[list(wrench)] = list(wrench.values())
    assert damping(velocity, **{name: 10.0})[0] == pytest.approx(expected)


def test_the_slope_is_the_derivative():
    random = np.random.default_rng(3)
    names = [f"{f}{v}{w}" for f in "xyzkmn" for v in "UVWPQR" for w in ("", "absQ", "U", "absV", "R")]
    named = {name: float(random.normal()) for name in names}
    velocity = random.normal(size=6)
    _, slope = damping(velocity, **named)
    small = 1e-6 * np.eye(6)
    numeric = [(damping(velocity + d, **named)[0] - damping(velocity - d, **named)[0]) / 2e-6 for d in small]
    assert slope == pytest.approx(-np.array(numeric).T, rel=1e-6, abs=1e-6)


def test_added_mass_is_positive_and_where_its_name_says():
    added = coefficients_of({"xDotU": -3.0, "mDotW": -2.0}).added_mass
    assert added[3, 3] == 3.0
    assert added[1, 5] == 2.0


@pytest.mark.parametrize("name", ["xD", "xu", "aU", "xUabs", "xDotUabsU", "", "xUVW"])
def test_other_names_are_none(name):
    with pytest.raises(ValueError, match="not a coefficient"):
        coefficients_of({name: 1.0})


def test_coriolis_forces_do_no_work_and_turn_the_momentum():
    random = np.random.default_rng(4)
    half = random.normal(size=(6, 6))
    inertia, velocity = (half @ half.T)[None], random.normal(size=(1, 6))
    (found,) = coriolis(inertia, velocity)
    assert found @ velocity[0] == pytest.approx(0)
    momentum = inertia[0] @ velocity[0]
    assert found[3:] == pytest.approx(np.cross(velocity[0, :3], momentum[3:]))
