from math import exp

import numpy as np
import pytest

from drake_twin.controllers.position_reach import PositionReach

NAN = np.nan


def make(period=0.01, velocity=None, T=0.2):
    return PositionReach.of_joint(0, velocity, 1, velocity_limit=2.0, time_constant=T, period=period)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_far_position_is_as_far_as_the_servo_moves_at_the_limit(sign):
    # The servo moves at error / 0.2 s: 0.4 rad are 2 rad/s.
    assert make().limited([sign * 9.0], [7.0, 1.0 * sign]) == pytest.approx(sign * 1.4)


def test_a_near_position_and_none_are_left_alone():
    assert make().limited([1.39], [7.0, 1.0]) == 1.39
    assert np.isnan(make().limited([NAN], [7.0, 1.0]))


def test_a_velocity_that_goes_with_the_position_counts():
    assert make(velocity=1).limited([9.0, 1.5], [7.0, 1.0]) == pytest.approx(1.0 + 0.2 * 0.5)
    assert make(velocity=1).limited([9.0, -1.5], [7.0, 1.0]) == pytest.approx(1.0 + 0.2 * 3.5)
    assert make(velocity=1).limited([9.0, NAN], [7.0, 1.0]) == pytest.approx(1.4)


@pytest.mark.parametrize("T", [0.002, 0.01, 0.05, 0.2])
def test_between_two_commands_the_servo_moves_by_nearly_as_much_as_the_limit_allows(T):
    error = make(T=T).limited([9.0], [7.0, 0.0])
    assert 0.94 * 2.0 * 0.01 <= error * (1 - exp(-0.01 / T)) <= 2.0 * 0.01
