"""gz-sim's AdvancedLiftDrag on its own: the wrench by the motion, beside formulas for one in the world frame."""

from math import atan2, cos, degrees, exp, pi, sin, sqrt

import numpy as np
import pytest
from controller_parameters import parameters_of
from device_harness import ROBOT, Running, setup_of
from moving_links import plant_of_hand, position_of, rotation, wrenches_of

from drake_twin.controllers.advanced_lift_drag import AdvancedLiftDrag, AircraftForces
from drake_twin.description.gazebo_drive import ADVANCED_LIFT_DRAG
from drake_twin.errors import InputError

KINDS = ("CL", "CD", "CY", "Cell", "Cem", "Cen")
ABSENT = {"CDa", "CDb", "Cema"}  # gz-sim has no such values, or writes over them
CRAFT = {"link_name": "palm", "AR": 5.0, "eff": 0.9, "area": 0.6, "alpha_stall": 0.3, "cp": [-0.1, 0.05, 0.02]}


def craft(seed=0, **given):
    random = np.random.default_rng(seed)
    names = [kind + slope for kind in KINDS for slope in "abpqr" if kind + slope not in ABSENT]
    values = {name: random.normal() for name in names} | {"CL0": 0.2, "CD0": 0.05, "CLa": 4.0}
    return AdvancedLiftDrag(
        setup_of(AdvancedLiftDrag, parameters_of(ADVANCED_LIFT_DRAG, **{**CRAFT, **values, **given}))
    )


@pytest.fixture(scope="module")
def plant():
    return plant_of_hand()


def wrenches(plant, crafts, *motion, **more):
    return wrenches_of(AircraftForces, plant, crafts, *motion, **more)


def expected(plant, craft, linear, angular, rpy, wind):
    """The same for one, force by force in the world frame."""
    R, rates = rotation(rpy), rotation(rpy).T @ angular * [1, -1, -1]
    cp = R @ craft.cp
    v = np.subtract(np.add(linear, np.cross(angular, cp)), wind)
    x, z = R @ craft.forward / np.linalg.norm(craft.forward), -R @ craft.upward / np.linalg.norm(craft.upward)
    y = np.cross(z, x)
    plane = v - (v @ y) * y
    speed = np.linalg.norm(plane)
    ahead = plane / speed
    alpha, beta = atan2(ahead @ z, ahead @ x), atan2(v @ y, v @ x)
    span = sqrt(craft.area * craft.AR)
    chord = craft.mac or craft.area / span
    reduced = rates * [span, chord, span] / 2 / speed

    def coefficient(kind, start=0.0):
        deflections = [position_of(plant, name) * way for name, way in zip(craft.joints, craft.directions, strict=True)]
        by_controls = sum(degrees(d) * c for d, c in zip(deflections, getattr(craft, f"{kind}_ctrl"), strict=True))
        return start + getattr(craft, f"{kind}b", 0.0) * beta + by_controls

    def rated(kind):
        return sum(getattr(craft, kind + slope) * rate for slope, rate in zip("pqr", reduced, strict=True))

    low, high = exp(-15 * (alpha - craft.alpha_stall)), exp(15 * (alpha + craft.alpha_stall))
    stalled = (1 + low + high) / ((1 + low) * (1 + high))
    lift = (1 - stalled) * (craft.CL0 + craft.CLa * alpha)
    lift = coefficient("CL", lift + stalled * 2 * alpha / abs(alpha) * sin(alpha) ** 2 * cos(alpha))
    plate = 2 / (1 + exp(-0.224 - 0.115 * max(craft.AR, 1 / craft.AR))) * abs(0.5 - 0.5 * cos(2 * alpha))
    drag = (1 - stalled) * (craft.CD0 + lift**2 / (pi * craft.AR * craft.eff)) + stalled * plate
    drag = coefficient("CD", drag)
    size = 0.5 * craft.air_density * speed**2 * craft.area
    force = size * (
        -(lift + rated("CL")) * np.cross(ahead, y)
        - (drag + rated("CD")) * ahead
        + (coefficient("CY", craft.CYa * alpha) + rated("CY")) * y
    )
    moment = size * (
        span * (coefficient("Cell", craft.Cella * alpha) + rated("Cell")) * x
        + chord * (coefficient("Cem") + rated("Cem")) * y
        + span * (coefficient("Cen", craft.Cena * alpha) + rated("Cen")) * z
    )
    return np.concatenate([R.T @ (moment + np.cross(cp, force)), R.T @ force])


COEFFICIENTS = {"CL": [0.01, 0.02], "CD": [0.003, -0.001], "CY": [0.04, 0.05]}
MOMENTS = {"Cell": [0.06, 0.07], "Cem": [0.08, -0.09], "Cen": [0.1, 0.11]}
BY_CONTROLS = {f"{kind}_ctrl": values for kind, values in {**COEFFICIENTS, **MOMENTS}.items()}
SURFACES = {"joints": ["thumb", "finger"], "directions": [-1.0, 2.0], **BY_CONTROLS}
CRAFTS = [
    {},
    {"mac": 0.4, "AR": 0.5},
    {"forward": [0.0, -2.0, 0.0], "upward": [1.0, 0.0, 1.0]},
    {"forward": [1.0, 0.0, 0.3], "upward": [0.0, 0.1, 1.0]},  # not across each other
    SURFACES,
    {"alpha_stall": 1.2, "air_density": 0.9},
]


def test_all_aircraft_at_once_have_the_wrenches_of_each_alone(plant):
    crafts, random = [craft(seed, **more) for seed, more in enumerate(CRAFTS)], np.random.default_rng(5)
    for _ in range(100):
        motion = random.normal(size=(4, 3)) * [[8.0], [1.0], [1.5], [2.0]]
        found = wrenches(plant, crafts, *motion)
        for item, one in zip(crafts, found, strict=True):
            np.testing.assert_allclose(one, expected(plant, item.setup.parameters, *motion), rtol=1e-6, atol=1e-6)


def test_a_flow_along_its_axis_is_like_one_beside_it(plant):
    dut = craft()
    (found,) = wrenches(plant, [dut], (10.0, 0.0, 0.0))
    near = expected(plant, dut.setup.parameters, (10.0, 0.0, -1e-7), np.zeros(3), np.zeros(3), np.zeros(3))
    np.testing.assert_allclose(found, near, rtol=1e-5, atol=1e-5)
    assert found[5] == pytest.approx(0.5 * 1.2041 * 100 * 0.6 * 0.2 / (1 + exp(-4.5)) ** 2)  # it stalls softly


def test_the_wind_counts_as_the_way_does_and_still_air_does_nothing(plant):
    (moving,) = wrenches(plant, [craft()], (8.0, 1.0, -2.0), rpy=(0.1, 0.2, 0.3))
    (blown,) = wrenches(plant, [craft()], (3.0, 1.0, 0.0), wind=(-5.0, 0.0, 2.0), rpy=(0.1, 0.2, 0.3))
    np.testing.assert_allclose(moving, blown)
    assert np.abs(moving).max() > 1.0
    assert not wrenches(plant, [craft()], (3.0, 0.0, 1.0), wind=(3.0, 0.0, 1.0)).any()


def test_it_acts_while_it_is_active_alone(plant):
    run = Running(craft())
    assert run.output("signals").tolist() == [1.0]
    run.controller.deactivate(run.context)
    assert run.output("signals").tolist() == [0.0]
    assert not wrenches(plant, [craft()], (9.0, 0.0, 0.0), active=0.0).any()


def test_a_joint_that_the_robot_does_not_have_is_a_problem():
    parameters = craft(**SURFACES).setup.parameters
    assert AdvancedLiftDrag.problem(parameters, ROBOT) is None
    missing = craft(**{**SURFACES, "joints": ["thumb", "toe"]}).setup.parameters
    assert AdvancedLiftDrag.problem(missing, ROBOT) == "the robot has no movable joint 'toe'"


@pytest.mark.parametrize(
    ("given", "what"),
    [
        ({"upward": [0.0, 0.0, 0.0]}, "upward is zero"),
        ({"cp": [0.0, 0.0]}, "cp has 2 numbers, where three are needed"),
        ({"AR": 0.0}, "0.0 is not above 0"),
        ({"eff": -1.0}, "-1.0 is not above 0"),
        ({"area": 0.0}, "0.0 is not above 0"),
        ({"mac": -0.1}, "is below 0"),
        ({**SURFACES, "CY_ctrl": [0.1]}, "CY_ctrl has 1 numbers for 2 joints"),
    ],
)
def test_parameters_that_cannot_be_are_refused(given, what):
    with pytest.raises(InputError, match=what):
        craft(**given)
