"""A diagram with its simulator: which robots are the same, and moments that it returns to."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import ARM, ROVER

from drake_twin.planning.robot_plan import is_same_robot
from drake_twin.scenario import Robot, Scenario
from drake_twin.twin.physics import Physics

STEP = 0.01


def plan_of(*robots):
    return Physics(Scenario(robots, time_step=STEP)).built.plans[0]


@pytest.fixture(scope="module")
def physics():
    return Physics(Scenario((Robot("rover", ROVER, xyz=(0, 0, 0.5)),), time_step=STEP))


@pytest.mark.parametrize("file", [ARM, ROVER])
def test_a_robot_is_the_same_as_itself_and_as_nothing_else(file):
    plan = plan_of(Robot("it", file))
    assert is_same_robot(plan, plan) is True
    assert is_same_robot(plan, None) is False
    assert not is_same_robot(plan, plan_of(Robot("other", file)))


@pytest.mark.parametrize(("file", "is_same"), [(ARM, True), (ROVER, False)])
def test_a_robot_elsewhere_is_the_same_if_it_is_welded_there(file, is_same):
    here, there = Robot("it", file), Robot("it", file, xyz=(1, 2, 0), rpy=(0, 0, 1))
    assert is_same_robot(plan_of(here), plan_of(there)) is is_same


def test_it_returns_to_a_moment_and_continues_to_the_same_bits(physics):
    physics.start_at_rest()
    physics.initialize()
    physics.simulator.AdvanceTo(3 * STEP)
    moment = physics.moment()
    physics.simulator.AdvanceTo(8 * STEP)
    end = physics.robot_state("rover")
    physics.go_back(moment)
    assert physics.context.get_time() == moment.time == 3 * STEP
    assert not np.array_equal(physics.robot_state("rover"), end)
    physics.simulator.AdvanceTo(8 * STEP)
    assert np.array_equal(physics.robot_state("rover"), end)


@pytest.mark.parametrize("length", [1.0, 1.9, 2.0, 5.0, 1e30])
def test_a_long_quaternion_is_halved_and_is_the_same_turn(physics, length):
    physics.start_at_rest()
    state = physics.robot_state("rover")
    turn = np.array([0.5, 0.5, -0.5, 0.5])
    state[:4] = length * turn
    physics.set_robot_state("rover", state)
    assert physics.settle()
    found = physics.robot_state("rover")
    size = np.linalg.norm(found[:4])
    assert 1.0 <= size < 2.0
    assert np.log2(length / size) == round(np.log2(length / size))
    assert found[:4] / size == pytest.approx(turn, rel=1e-15)
    assert np.array_equal(found[4:], state[4:])


def test_a_state_that_cannot_be_is_noticed(physics):
    physics.start_at_rest()
    state = physics.robot_state("rover")
    state[-1] = 1e300
    physics.set_robot_state("rover", state)
    assert not physics.settle()
    assert not physics.check()


@pytest.mark.parametrize(("length", "is_halved"), [(1.9, False), (1e3, True), (1e30, True)])
def test_a_check_after_an_advance_halves_a_quaternion_long_before_it_overflows(physics, length, is_halved):
    physics.start_at_rest()
    state = physics.robot_state("rover")
    state[:4] = length, 0, 0, 0
    physics.set_robot_state("rover", state)
    assert physics.check()
    assert bool(physics.robot_state("rover")[0] < length) is is_halved


def test_the_end_of_a_step_is_that_many_steps_from_zero(physics):
    assert [physics.time_of(step) for step in (0, 1, 7)] == [0.0, STEP, 7 * STEP]


def test_values_are_set_at_once_and_taken_back_at_the_start(physics):
    body = physics.built.plant.GetBodyByName("rover_base_link", physics.built.robots["rover"].instance)
    physics.start_at_rest()
    before = body.get_mass(physics.plant_context)
    physics.set_values({"rover.payload": 4.0})
    assert body.get_mass(physics.plant_context) == pytest.approx(before + 4.0)
    physics.set_values({})
    assert body.get_mass(physics.plant_context) == before


def test_the_state_of_the_same_robot_goes_over_to_another_diagram():
    robots = (Robot("arm", ARM), Robot("rover", ROVER, xyz=(0, 2, 0.13)))
    old = Physics(Scenario(robots, time_step=STEP))
    state = old.robot_state("arm")
    state[0] = 0.4
    old.set_robot_state("arm", state)
    moved = replace(robots[0], xyz=(5, 0, 0))
    new = Physics(Scenario((moved, replace(robots[1], xyz=(0, 9, 0.13))), time_step=STEP), known=old.built)
    new.transfer(old.state(), old)
    assert np.array_equal(new.robot_state("arm"), state)
    assert new.robot_state("rover")[5] == 9.0  # it is not welded, and starts where the scenario says
