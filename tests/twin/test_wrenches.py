"""Forces and torques that begin, end and are taken back, step by step."""

import pytest
from conftest import ROVER

from drake_twin.scenario import Push, Robot, Scenario
from drake_twin.twin.clock import Clock
from drake_twin.twin.entity_state import Wrench
from drake_twin.twin.physics import Physics
from drake_twin.twin.plain_data import to_plain
from drake_twin.twin.wrenches import Wrenches

STEP = 0.01
PUSH = Push("rover", 0.05, force=(1.0, 2.0, 3.0), duration=0.1, at=(0.1, 0.2, 0.3))


def steady(until, entity="rover", force=(1.0, 0.0, 0.0)):
    return Wrench(entity, force, (0.0, 0.0, 0.0), until)


@pytest.fixture(scope="module")
def physics():
    return Physics(Scenario((Robot("rover", ROVER),), time_step=STEP))


@pytest.fixture
def clock():
    return Clock(STEP)


@pytest.fixture
def dut(physics):
    found = Wrenches()
    found.use(physics, ["rover"])
    found.start([PUSH])
    return found


def at(clock, step):
    clock.go_to(step)
    return clock


def test_a_push_begins_at_its_step_and_ends_after_its_duration(dut, clock):
    dut.update(at(clock, 4))
    assert (dut.items, dut.pushes) == ((), (PUSH,))
    assert dut.due_steps(clock) == [5]
    dut.update(at(clock, 5))
    (wrench,) = dut.items
    assert (wrench.entity, wrench.force, wrench.torque, wrench.at) == ("rover", PUSH.force, (0, 0, 0), PUSH.at)
    assert wrench.until == pytest.approx(0.15)
    assert dut.pushes == ()
    assert dut.due_steps(clock) == [15]
    dut.update(at(clock, 14))
    assert dut.items == (wrench,)
    dut.update(at(clock, 15))
    assert dut.items == ()


def test_a_push_without_a_duration_is_of_one_step(dut, clock):
    dut.start([Push("rover", 0.0, force=(1.0, 0.0, 0.0), duration=0.0, at=(0.0, 0.0, 0.0))])
    dut.update(clock)
    assert [wrench.until for wrench in dut.items] == [STEP]


def test_a_step_that_fails_has_its_wrenches_taken_back(dut, clock):
    dut.put([steady(0.05)])
    before = dut.items
    dut.update(at(clock, 5))
    assert dut.items != before
    dut.take_back()
    assert (dut.items, dut.pushes) == (before, (PUSH,))


def test_wrenches_on_what_is_gone_are_gone(physics, dut):
    dut.put([steady(1.0), steady(1.0, "rover::rover_base_link")])
    dut.use(physics, ["rover"])
    assert (len(dut.items), len(dut.pushes)) == (2, 1)
    dut.use(physics, ["other"])
    assert (dut.items, dut.pushes) == ((), ())


def test_its_state_is_that_of_another(physics, dut, clock):
    dut.put([steady(1.0)])
    other = Wrenches()
    other.use(physics, ["rover"])
    other.set_state(dut.state())
    assert (other.items, other.pushes) == (dut.items, dut.pushes)
    with pytest.raises(ValueError, match="not a push"):
        other.set_state({"wrenches": to_plain(()), "pushes": [to_plain(steady(1.0))]})
