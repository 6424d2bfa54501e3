"""gz-sim's LiftDrag on its own: the wrench on a link by its motion, beside formulas for one wing in the world frame."""

from dataclasses import replace
from math import acos, cos, pi

import numpy as np
import pytest
from controller_parameters import parameters_of
from device_harness import ROBOT, Running, setup_of
from moving_links import plant_of_hand, position_of, rotation, wrenches_of

from drake_twin.controllers.lift_drag import LiftDrag, WingForces
from drake_twin.description.gazebo_drive import LIFT_DRAG
from drake_twin.errors import InputError

STALLS = {"alpha_stall": 0.3, "cla_stall": -2.5, "cda_stall": 0.8, "cma_stall": -1.5}
WING = {"link_name": "palm", "a0": 0.05, "cla": 4.0, "cda": 0.6, "cma": -0.3, "area": 0.7, **STALLS}


def wing(**given):
    return LiftDrag(setup_of(LiftDrag, parameters_of(LIFT_DRAG, **{**WING, **given})))


@pytest.fixture(scope="module")
def plant():
    return plant_of_hand()


def wrenches(plant, wings, *motion, **more):
    return wrenches_of(WingForces, plant, wings, *motion, **more)


def coefficients(wing, alpha):
    """Of lift, drag and moment, before the sweep."""
    stall, found = wing.alpha_stall, []
    for kind in ("cla", "cma"):
        before, behind = getattr(wing, kind), getattr(wing, f"{kind}_stall")
        if abs(alpha) <= stall:
            found.append(before * alpha)
        elif alpha > stall:
            found.append(max(0.0, before * stall + behind * (alpha - stall)))
        else:
            found.append(min(0.0, -before * stall + behind * (alpha + stall)))
    drag = wing.cda * min(stall, abs(alpha)) + wing.cda_stall * max(0.0, abs(alpha) - stall)
    return [found[0], abs(drag), found[1]]


def expected(plant, wing, linear, angular, rpy, wind):
    """The same as `wrenches` for one wing, by projections in the world frame."""
    R = rotation(rpy)
    cp = R @ wing.cp
    v = np.subtract(np.add(linear, np.cross(angular, cp)), wind)
    forward = R @ wing.forward / np.linalg.norm(wing.forward)
    if np.linalg.norm(v) <= 0.01 or (forward @ v <= 0 and not wing.reversible):
        return np.zeros(6)
    upward = R @ wing.upward / np.linalg.norm(wing.upward)
    if wing.radial_symmetry:
        upward = (forward @ v) * forward - v
        upward /= np.linalg.norm(upward)
    span = np.cross(forward, upward)
    span /= np.linalg.norm(span)
    sweep = np.arcsin(span @ v / np.linalg.norm(v))
    plane = v - (v @ span) * span
    speed = np.linalg.norm(plane)
    lifts = np.cross(span, plane) / speed
    alpha = wing.a0 + acos(np.clip(lifts @ upward, -1, 1)) * (1 if lifts @ forward >= 0 else -1)
    while alpha > pi / 2:
        alpha -= pi
    while alpha < -pi / 2:
        alpha += pi
    lift, drag, moment = (value * cos(sweep) ** 2 for value in coefficients(wing, alpha))
    if wing.control_joint_name:
        position = position_of(plant, wing.control_joint_name)
        lift += wing.control_joint_rad_to_cl * position
        moment += wing.cm_delta * position
    size = 0.5 * wing.air_density * speed**2 * wing.area
    force = size * (lift * lifts - drag * plane / speed)
    torque = size * moment * span + np.cross(cp, force)
    return np.concatenate([R.T @ torque, R.T @ force])


KINDS = [
    {},
    {"radial_symmetry": True},
    {"reversible": True},
    {"radial_symmetry": True, "reversible": True, "upward": [1.0, 0.0, 0.0]},
    {"forward": [0.0, -2.0, 0.0], "upward": [0.3, 0.5, 1.0]},  # not across each other
    {"control_joint_name": "thumb", "control_joint_rad_to_cl": 2.0, "cm_delta": -0.4},
    {"cp": [0.2, -0.5, 0.1]},
    {"a0": -2.0, "alpha_stall": 1.0},
    {"cla_stall": -60.0, "cma_stall": 50.0},  # which would turn lift and moment round
]


def test_all_wings_at_once_have_the_wrenches_of_each_alone(plant):
    wings, random = [wing(**kind) for kind in KINDS], np.random.default_rng(7)
    for _ in range(200):
        motion = random.normal(size=(4, 3)) * [[8.0], [1.0], [1.5], [2.0]]
        found = wrenches(plant, wings, *motion)
        for item, one in zip(wings, found, strict=True):
            np.testing.assert_allclose(one, expected(plant, item.setup.parameters, *motion), rtol=1e-6, atol=1e-6)


def test_air_takes_energy_and_never_gives_any(plant):
    wings = [wing(**kind, cma=0.0, cma_stall=0.0) for kind in (*KINDS[:5], KINDS[6]) if "cma_stall" not in kind]
    for linear in np.random.default_rng(3).normal(size=(100, 3)) * 5.0:
        for item, one in zip(wings, wrenches(plant, wings, linear), strict=True):
            assert one[3:] @ linear <= 1e-9, item.setup.parameters


def test_the_wind_counts_as_the_way_does(plant):
    (moving,) = wrenches(plant, [wing()], (8.0, 1.0, -2.0), rpy=(0.1, 0.2, 0.3))
    (blown,) = wrenches(plant, [wing()], (3.0, 1.0, 0.0), wind=(-5.0, 0.0, 2.0), rpy=(0.1, 0.2, 0.3))
    np.testing.assert_allclose(moving, blown)
    assert np.abs(moving).max() > 1.0


def test_what_is_round_and_flies_along_its_axis_has_the_drag_of_its_first_angle_alone(plant):
    round_one = wing(radial_symmetry=True)
    (found,) = wrenches(plant, [round_one], (10.0, 0.0, 0.0))
    near = expected(plant, round_one.setup.parameters, (10.0, 0.0, 1e-6), np.zeros(3), np.zeros(3), np.zeros(3))
    assert found[3] == pytest.approx(near[3], rel=1e-5)
    assert found[3] == pytest.approx(-0.5 * 1.2041 * 100 * 0.7 * 0.6 * 0.05)


@pytest.mark.parametrize("linear", [(0.0, 0.0, 0.0), (0.009, 0.0, 0.0), (-5.0, 0.0, 0.1), (0.0, 3.0, 0.0)])
def test_still_air_and_air_from_behind_or_the_side_do_nothing(plant, linear):
    assert not wrenches(plant, [wing()], linear).any()


def test_it_acts_while_it_is_active_alone(plant):
    run = Running(wing())
    assert run.output("signals").tolist() == [1.0]
    run.controller.deactivate(run.context)
    assert run.output("signals").tolist() == [0.0]
    assert not wrenches(plant, [wing()], (9.0, 0.0, 0.0), active=0.0).any()
    assert wrenches(plant, [wing()], (9.0, 0.0, 0.0)).any()


@pytest.mark.parametrize(
    ("given", "problem"),
    [
        ({}, None),
        ({"link_name": "arm"}, "the robot has no link 'arm'"),
        ({"control_joint_name": "thumb"}, None),
        ({"control_joint_name": "toe"}, "the robot has no movable joint 'toe'"),
    ],
)
def test_a_link_or_a_joint_that_the_robot_does_not_have_is_a_problem(given, problem):
    assert LiftDrag.problem(parameters_of(LIFT_DRAG, **{**WING, **given}), ROBOT) == problem


def test_a_joint_that_does_not_move_is_a_problem():
    stiff = replace(ROBOT, joints=(replace(ROBOT.joints[0], type="fixed"),))
    parameters = parameters_of(LIFT_DRAG, link_name="palm", control_joint_name="finger")
    assert LiftDrag.problem(parameters, stiff) == "the robot has no movable joint 'finger'"


@pytest.mark.parametrize(
    ("given", "what"),
    [
        ({"cp": [1.0, 2.0]}, "cp has 2 numbers, where three are needed"),
        ({"forward": [0.0, 0.0, 0.0]}, "forward is zero"),
        ({"upward": [-2.0, 0.0, 0.0]}, "upward is along forward"),
        ({"area": -1.0}, "is below 0"),
        ({"air_density": -1.2}, "is below 0"),
        ({"alpha_stall": -0.1}, "is below 0"),
    ],
)
def test_parameters_that_cannot_be_are_refused(given, what):
    with pytest.raises(InputError, match=what):
        wing(**given)
