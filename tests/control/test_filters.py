"""Hold against the control_filters tests of control_toolbox, cited by file and line."""

from math import exp, pi

import pytest

from drake_twin.control.filters import ExponentialFilter, LowPass, MeanFilter, RateLimiter
from drake_twin.control.low_pass_filter import LowPassFilter
from drake_twin.control.speed_limiter import SpeedLimiter


class Run:
    """A filter with what it keeps."""

    def __init__(self, filter):
        self.filter = filter
        self.memory = ()

    def __call__(self, value):
        result, self.memory = self.filter.update(value, self.memory)
        return result


def test_a_mean_is_that_of_the_last_values():
    mean = Run(MeanFilter(3))
    assert [mean(value) for value in (3.0, 5.0, 10.0, 9.0, -1.0)] == [3.0, 4.0, 6.0, 8.0, 6.0]


def test_an_exponential_filter_starts_at_its_first_value_and_decays():
    smooth = Run(ExponentialFilter(0.7))
    assert smooth(1.0) == 1.0  # test_exponential_filter.cpp:56
    assert smooth(1.0) == 1.0  # test_exponential_filter.cpp:62
    expected = 1.0
    for _ in range(100):
        expected = 0.7 * 0.0 + (1 - 0.7) * expected
        assert smooth(0.0) == expected  # test_exponential_filter.cpp:70


def test_a_low_pass_filter_passes_its_first_value_and_follows_its_difference_equation():
    low_pass = Run(LowPass(LowPassFilter(1000.0, 20.5, 1.25)))
    a = exp(-1.0 / 1000.0 * (2.0 * pi * 20.5) / 10.0 ** (1.25 / -10.0))
    assert low_pass(1.0) == 1.0  # test_low_pass_filter.cpp:173
    before = low_pass(2.0)
    assert before == pytest.approx(1.0)  # the equation takes the input before
    assert low_pass(2.0) == pytest.approx((1.0 - a) * 2.0 + a * before)  # test_low_pass_filter.cpp:186


def test_a_rate_limiter_takes_fifteen_steps_from_ten_to_zero():
    limits = SpeedLimiter(
        max_acceleration_reverse=-1.0,
        max_acceleration=1.0,
        max_deceleration=-1.0,
        max_deceleration_reverse=1.0,
        min_jerk=-0.1,
        max_jerk=0.1,
    )
    limited = Run(RateLimiter(limits, 1.0))
    for _ in range(10):
        assert limited(10.0) == 10.0  # test_rate_limiter.cpp:93
    for _ in range(14):
        assert abs(limited(0.0)) > 1e-6  # test_rate_limiter.cpp:100
    assert limited(0.0) == pytest.approx(0.0, abs=1e-6)  # test_rate_limiter.cpp:103
