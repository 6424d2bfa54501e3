"""The state machine of an elevator."""

from dataclasses import replace

import pytest

from drake_twin.control.elevator_states import (
    CLOSING,
    IDLE,
    MOVING,
    OPENING,
    WAITING,
    ElevatorState,
    Measured,
    asked,
    updated,
)
from drake_twin.description.elevator_shaft import Shaft

SHAFT = Shaft(floors=(0.0, 3.0, 6.0, 9.0), doors=(0.5, 0.6, 0.7, 0.8), wait=2.0)
MOVE, OPEN, CLOSE = range(4), range(4, 8), range(8, 12)  # the numbers of orders


def now(time=0.0, cabin=0.0, speed=0.0, door=0.0, blocked=False):
    """Returns what is measured where all doors are alike."""
    return Measured(time, (cabin, speed), [(door, 0.0)] * 4, [blocked] * 4)


def test_an_idle_elevator_goes_to_the_floor_that_it_is_asked_for():
    state = asked(ElevatorState(), 2, SHAFT)
    assert (state.phase, state.targets, state.orders) == (MOVING, (2,), (MOVE[2],))


def test_at_its_own_floor_it_opens_the_door_at_once():
    state = asked(ElevatorState(floor=1), 1, SHAFT)
    assert (state.phase, state.targets, state.door, state.orders) == (OPENING, (), 1, (OPEN[1],))


def test_it_opens_the_door_waits_closes_it_and_is_idle():
    state = ElevatorState(phase=MOVING, targets=(2,))
    state = updated(state, now(cabin=5.9, speed=0.5), SHAFT)  # near, but on its way up
    assert (state.phase, state.floor) == (MOVING, 2)
    state = updated(state, now(cabin=5.84), SHAFT)  # at rest, but more than 0.15 m away
    assert state.phase == MOVING
    state = updated(state, now(10.0, cabin=5.9, speed=0.009), SHAFT)
    assert (state.phase, state.targets, state.orders) == (OPENING, (), (OPEN[2],))
    state = updated(replace(state, orders=()), now(11.0, cabin=6, door=0.67), SHAFT)
    assert state.phase == OPENING
    state = updated(state, now(12.0, cabin=6, door=0.69), SHAFT)
    assert (state.phase, state.orders) == (WAITING, ())
    state = updated(state, now(13.9, cabin=6, door=0.7), SHAFT)
    assert state.phase == WAITING
    state = updated(state, now(14.0, cabin=6, door=0.7), SHAFT)
    assert (state.phase, state.orders) == (CLOSING, (CLOSE[2],))
    state = updated(state, now(15.0, cabin=6, door=0.03), SHAFT)
    assert state.phase == CLOSING
    state = updated(state, now(16.0, cabin=6, door=0.01), SHAFT)
    assert state.phase == IDLE


def test_a_blocked_doorway_keeps_the_door_open_and_the_wait_begins_again():
    state = ElevatorState(phase=WAITING, timeout=14.0)
    state = updated(state, now(13.0, door=0.5, blocked=True), SHAFT)
    state = updated(state, now(20.0, door=0.5, blocked=True), SHAFT)
    assert state.phase == WAITING
    state = updated(state, now(20.1, door=0.5), SHAFT)
    state = updated(state, now(22.0, door=0.5), SHAFT)
    assert state.phase == WAITING
    state = updated(state, now(22.1, door=0.5), SHAFT)
    assert state.phase == CLOSING


@pytest.mark.parametrize(
    ("floor", "targets", "target", "queue"),
    [
        (0, (), 2, (2,)),
        (0, (3,), 1, (1, 3)),  # on its way up
        (0, (1, 3), 2, (1, 2, 3)),
        (3, (0,), 2, (2, 0)),  # on its way down
        (2, (3,), 0, (3, 0)),  # behind it
        (1, (3, 0), 2, (2, 3, 0)),
        (0, (2,), 2, (2,)),  # asked for already
        (2, (0,), 2, (0, 2)),  # its own floor: gz-sim does not count the upper end of a way
        (0, (2,), 0, (0, 2)),  # but the lower one
    ],
)
def test_a_floor_on_the_way_comes_first(floor, targets, target, queue):
    state = asked(ElevatorState(phase=CLOSING, floor=floor, targets=targets), target, SHAFT)
    assert state.targets == queue
    assert state.orders == ()


def test_what_is_asked_for_while_it_moves_waits_until_the_door_closes():
    state = asked(ElevatorState(phase=MOVING, targets=(3,)), 1, SHAFT)
    state = asked(state, 0, SHAFT)
    assert (state.targets, state.later) == ((3,), (1, 0))
    state = updated(replace(state, phase=WAITING, targets=(), floor=3), now(5.0, cabin=9.0, door=0.8), SHAFT)
    assert (state.phase, state.targets, state.later, state.orders) == (CLOSING, (1, 0), (), (CLOSE[3],))
    state = updated(replace(state, orders=()), now(7.0, cabin=9.0), SHAFT)
    assert (state.phase, state.orders) == (MOVING, (MOVE[1],))


def test_two_steps_may_be_in_one_update():
    """The door is closed, and the cabin is at the next floor already, as it was moved there by hand."""
    state = updated(ElevatorState(phase=CLOSING, targets=(1,)), now(cabin=3.0), SHAFT)
    assert (state.phase, state.door, state.orders) == (OPENING, 1, (MOVE[1], OPEN[1]))


def test_floors_may_be_near_to_each_other():
    near = Shaft(floors=(0.0, 0.4, 0.8), doors=(1.0, 1.0, 1.0), wait=1.0)
    state = updated(ElevatorState(), Measured(0.0, (0.5, 0.0), [(0, 0)] * 3, [False] * 3), near)
    assert state.floor == 1
