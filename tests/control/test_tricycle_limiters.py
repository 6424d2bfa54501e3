import pytest

from drake_twin.control.tricycle_limiters import SteeringLimiter, TractionLimiter


def test_without_limits_commands_pass_unchanged():
    assert TractionLimiter().limited(1.23, 0.1, 0.7, 0.01) == 1.23
    assert SteeringLimiter().limited(-1.23, 0.1, 0.7, 0.01) == -1.23


def test_one_speed_limit_holds_in_both_directions():
    limiter = TractionLimiter(max_velocity=2.0)
    assert limiter.limited(5.0, 0.0, 0.0, 0.1) == 2.0
    assert limiter.limited(-5.0, 0.0, 0.0, 0.1) == -2.0


def test_a_smallest_speed_is_a_floor():
    assert TractionLimiter(min_velocity=0.5, max_velocity=2.0).limited(-0.1, 0.0, 0.0, 0.1) == -0.5


def test_speeding_up_and_braking_have_their_own_limits():
    limiter = TractionLimiter(max_acceleration=5.0, max_deceleration=8.0)
    assert limiter.limited(9.0, 1.0, 1.0, 0.1) == pytest.approx(1.5)
    assert limiter.limited(0.0, 1.0, 1.0, 0.1) == pytest.approx(0.2)
    assert limiter.limited(-9.0, -1.0, -1.0, 0.1) == pytest.approx(-1.5)


def test_traction_jerk_is_twice_the_jerk_times_the_period_squared():
    # upstream's 2 · dt²: from rest 2 · 3 · 0.01 = 0.06
    assert TractionLimiter(max_jerk=3.0).limited(9.0, 0.0, 0.0, 0.1) == pytest.approx(0.06)


def test_steering_angle_and_speed_are_limited():
    limiter = SteeringLimiter(min_position=-0.3, max_position=0.5, max_velocity=1.0)
    assert limiter.limited(0.4, 0.0, 0.0, 0.1) == pytest.approx(0.1)
    assert limiter.limited(9.0, 0.45, 0.35, 0.1) == pytest.approx(0.5)
    assert limiter.limited(-9.0, -0.25, -0.2, 0.1) == pytest.approx(-0.3)


def test_steering_acceleration_limits_the_change_of_the_change():
    assert SteeringLimiter(max_acceleration=3.0).limited(9.0, 1.0, 0.9, 0.1) == pytest.approx(1.1 + 0.06)


@pytest.mark.parametrize("what", ["velocity", "acceleration", "deceleration", "jerk"])
def test_negative_and_disordered_traction_limits_are_refused(what):
    with pytest.raises(ValueError, match=f"a limit of {what} is negative"):
        TractionLimiter(**{f"max_{what}": -1.0})
    with pytest.raises(ValueError, match=f"the {what} limits are in the wrong order: 2 is above 1"):
        TractionLimiter(**{f"min_{what}": 2.0, f"max_{what}": 1.0})


def test_disordered_steering_limits_are_refused():
    with pytest.raises(ValueError, match="the position limits are in the wrong order: 2 is above 1"):
        SteeringLimiter(min_position=2.0, max_position=1.0)
