from math import nan

import pytest

from drake_twin.control.speed_limiter import SpeedLimiter


def ramp(limiter, target, updates, period=0.1, speed=0.0):
    """What comes out of a limiter that is asked for one speed again and again."""
    before, out = speed, []
    for _ in range(updates):
        before, speed = speed, limiter.limited(target, speed, before, period)
        out.append(speed)
    return out


def test_without_limits_a_speed_passes_unchanged():
    assert SpeedLimiter().limited(123.456, 0.1, -7.0, 0.01) == 123.456


def test_a_speed_is_clamped_and_a_minimum_that_is_not_given_is_the_maximums_opposite():
    assert SpeedLimiter(max_velocity=0.5).limited(9.0, 0.0, 0.0, 0.1) == 0.5
    assert SpeedLimiter(max_velocity=0.5).limited(-9.0, 0.0, 0.0, 0.1) == -0.5
    assert SpeedLimiter(min_velocity=-0.2, max_velocity=0.5).limited(-9.0, 0.0, 0.0, 0.1) == -0.2


def test_acceleration_makes_a_straight_ramp():
    assert ramp(SpeedLimiter(max_acceleration=2.0), 1.0, 7) == pytest.approx([0.2, 0.4, 0.6, 0.8, 1.0, 1.0, 1.0])


def test_each_way_of_speeding_up_and_braking_has_its_own_limit():
    limiter = SpeedLimiter(
        max_acceleration=1.0, max_acceleration_reverse=-2.0, max_deceleration=-3.0, max_deceleration_reverse=4.0
    )
    period = 0.1
    assert limiter.limited(9.0, 0.0, 0.0, period) == pytest.approx(0.1)  # forwards from rest
    assert limiter.limited(9.0, 1.0, 1.0, period) == pytest.approx(1.1)  # faster forwards
    assert limiter.limited(-9.0, 1.0, 1.0, period) == pytest.approx(0.7)  # braking forwards
    assert limiter.limited(-9.0, 0.0, 0.0, period) == pytest.approx(-0.2)  # backwards from rest
    assert limiter.limited(-9.0, -1.0, -1.0, period) == pytest.approx(-1.2)  # faster backwards
    assert limiter.limited(9.0, -1.0, -1.0, period) == pytest.approx(-0.6)  # braking backwards


def test_deceleration_that_is_not_given_is_the_acceleration_the_other_way():
    limiter = SpeedLimiter(max_acceleration=1.0, max_acceleration_reverse=-2.0)
    assert limiter.limited(-9.0, 1.0, 1.0, 0.1) == pytest.approx(0.8)
    assert limiter.limited(9.0, -1.0, -1.0, 0.1) == pytest.approx(-0.9)


def test_the_other_acceleration_limits_count_only_with_max_acceleration():
    assert SpeedLimiter(max_deceleration=-1.0).limited(0.0, 5.0, 5.0, 0.1) == 0.0


def test_jerk_makes_the_acceleration_grow_by_equal_steps():
    # jerk · period² = 0.1: the speed's increments are 0.1, 0.2, 0.3, …
    assert ramp(SpeedLimiter(max_jerk=10.0), 100.0, 4) == pytest.approx([0.1, 0.3, 0.6, 1.0])


def test_jerk_is_limited_when_braking_begins_but_not_when_an_acceleration_eases_off():
    # 1.0 after 0.7: going on as before is 1.3, less 10 · 0.1² is 1.2
    assert SpeedLimiter(max_jerk=10.0).limited(0.0, 1.0, 0.7, 0.1) == pytest.approx(1.2)
    assert SpeedLimiter(max_jerk=10.0).limited(1.05, 1.0, 0.7, 0.1) == 1.05


def test_acceleration_is_not_exceeded_for_the_sake_of_jerk():
    assert ramp(SpeedLimiter(max_jerk=10.0, max_acceleration=2.0), 100.0, 4) == pytest.approx([0.1, 0.3, 0.5, 0.7])


@pytest.mark.parametrize(
    ("limits", "what"),
    [
        ({"min_velocity": 2.0, "max_velocity": 1.0}, "velocity"),
        ({"max_acceleration_reverse": 2.0, "max_acceleration": 1.0}, "acceleration"),
        ({"max_acceleration": 1.0, "max_deceleration": 2.0}, "deceleration"),
        ({"min_jerk": 2.0, "max_jerk": 1.0}, "jerk"),
    ],
)
def test_limits_in_the_wrong_order_are_refused(limits, what):
    with pytest.raises(ValueError, match=f"the {what} limits are in the wrong order: 2 is above 1"):
        SpeedLimiter(**limits)


def test_a_minimum_alone_limits_nothing():
    assert SpeedLimiter(min_velocity=-1.0, min_jerk=-1.0, max_jerk=nan).limited(-5.0, 0.0, 0.0, 0.1) == -5.0
