"""One joint with a position gain of 10 N·m/rad, T = 0.2 s, an effort limit of 5 N·m and a velocity limit of 2 rad/s."""

from dataclasses import replace
from math import inf, nan

import pytest

from drake_twin.systems.joint_servo import ServoAssignment
from drake_twin.twin.servo_modes import (
    DrivenJoint,
    JointMotion,
    check_period,
    next_modes,
    released,
    without_commands,
)

JOINT = DrivenJoint(stiffness=10.0, time_constant=0.2, yields=0.5, lower=-1.0, upper=1.0, velocity_limit=2.0)
VELOCITY_CLAIMED = ServoAssignment(("hold",), (0.3,), (-1,), (0,), (-1,))
POSITION_CLAIMED = ServoAssignment(("hold",), (0.3,), (0,), (-1,), (-1,))
UNCLAIMED = ServoAssignment(("hold",), (0.3,), (-1,), (-1,), (-1,))


def motion(position=0.3, velocity=0.0, gravity=0.0, target=nan, speed=nan):
    return JointMotion([position], [velocity], [gravity], [target], [speed])


def after(mode, claimed=VELOCITY_CLAIMED, joint=JOINT, is_check=True, **now):
    result = next_modes(replace(claimed, modes=(mode,)), [joint], motion(**now), is_check=is_check)
    return result.modes[0], result.holds[0]


@pytest.mark.parametrize("mode", ["hold", "brake", "velocity"])
def test_a_commanded_velocity_is_followed_at_once(mode):
    assert after(mode, speed=-0.1, is_check=False) == ("velocity", 0.3)


@pytest.mark.parametrize("speed", [0.0, -0.0, nan])
def test_a_velocity_of_zero_brakes_what_moves_and_holds_what_is_held(speed):
    assert after("velocity", speed=speed, velocity=1.0) == ("brake", 0.3)
    assert after("hold", speed=speed) == ("hold", 0.3)


def test_a_braking_joint_is_held_ahead_where_its_servo_bears_gravity_once_it_is_at_rest():
    assert after("brake", velocity=2e-3) == ("brake", 0.3)
    assert after("brake", velocity=5e-4, is_check=False) == ("brake", 0.3)
    mode, hold = after("brake", position=0.5, velocity=5e-4, gravity=-2.0)
    assert (mode, hold) == ("hold", pytest.approx(0.5 + 5e-4 * 0.2 + 0.2))
    assert after("brake", position=1.0, gravity=-2.0) == ("hold", 1.0)  # its upper limit


def test_a_held_joint_slips_where_a_velocity_is_commanded_and_more_than_its_effort_pushes_it():
    assert after("hold", position=0.81, speed=0.0) == ("brake", 0.3)
    assert after("hold", position=0.79, speed=0.0) == ("hold", 0.3)
    assert after("hold", position=0.81, speed=0.0, is_check=False) == ("hold", 0.3)
    assert after("hold", claimed=UNCLAIMED, position=0.81) == ("hold", 0.3)


def test_a_far_position_is_approached_at_the_limit_until_its_servo_is_no_faster():
    assert after("hold", POSITION_CLAIMED, target=0.9) == ("up", 0.3)
    assert after("position", POSITION_CLAIMED, target=-0.9) == ("down", 0.3)
    assert after("up", POSITION_CLAIMED, position=0.51, target=0.9) == ("position", 0.3)
    assert after("hold", POSITION_CLAIMED, replace(JOINT, velocity_limit=inf), target=0.9) == ("position", 0.3)


def test_a_position_that_is_no_longer_commanded_brakes():
    assert after("position", POSITION_CLAIMED) == ("brake", 0.3)
    assert after("up", POSITION_CLAIMED) == ("brake", 0.3)


@pytest.mark.parametrize("mode", ["effort", "free"])
def test_efforts_and_limp_joints_are_left_alone(mode):
    assert after(mode, speed=1.0, velocity=1.0) == (mode, 0.3)


def test_only_a_joint_that_rests_where_it_was_told_to_be_stays_held_there():
    at_target = replace(POSITION_CLAIMED, modes=("position",))
    assert without_commands(at_target, [JOINT], motion(position=0.495, target=0.5)) == (("hold",), (0.5,))
    assert without_commands(at_target, [JOINT], motion(position=0.4, target=0.5))[0] == ("brake",)
    assert without_commands(at_target, [JOINT], motion(position=0.5, target=0.5, velocity=0.01))[0] == ("brake",)
    assert without_commands(UNCLAIMED, [JOINT], motion(velocity=0.01)) == (("hold",), (0.3,))
    assert without_commands(replace(VELOCITY_CLAIMED, modes=("velocity",)), [JOINT], motion())[0] == ("brake",)


def test_nothing_is_looked_at_while_nothing_brakes_or_may_slip():
    assert check_period(UNCLAIMED) is None
    assert check_period(POSITION_CLAIMED) is None
    assert check_period(replace(VELOCITY_CLAIMED, modes=("velocity",))) is None
    assert check_period(VELOCITY_CLAIMED) == pytest.approx(0.2)
    for mode in ("brake", "up", "down"):
        assert check_period(replace(UNCLAIMED, modes=(mode,))) == pytest.approx(0.01)


def test_a_joint_that_was_put_elsewhere_is_held_there_where_a_velocity_is_commanded():
    assert released(VELOCITY_CLAIMED, [0]).modes == ("brake",)
    assert released(VELOCITY_CLAIMED, []).modes == ("hold",)
    assert released(UNCLAIMED, [0]).modes == ("hold",)
