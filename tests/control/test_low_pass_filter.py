from math import exp, pi

import numpy as np
import pytest
from scipy.signal import lfilter

from drake_twin.control.low_pass_filter import LowPassFilter, LowPassMemory

FILTER = LowPassFilter(sampling_frequency=100.0, damping_frequency=5.0, damping_intensity=3.0)


def filtered(values, memory=LowPassMemory()):  # noqa: B008
    out = []
    for value in values:
        result, memory = FILTER.update(np.atleast_1d(np.asarray(value, dtype=float)), memory)
        out.append(result)
    return np.array(out)


def test_the_coefficient_is_control_toolboxs():
    assert FILTER.feedback == pytest.approx(exp(-2 * pi * 5 / 100 / 10**-0.3), rel=1e-15)


def test_a_signal_is_filtered_as_by_scipy_with_one_sample_of_delay():
    signal = np.random.default_rng(1).normal(size=200)
    a = FILTER.feedback
    # In steady state at the first value: y[-1] = x[-1] = signal[0].
    expected, _ = lfilter([0.0, 1.0 - a], [1.0, -a], signal, zi=[signal[0]])
    np.testing.assert_allclose(filtered(signal)[:, 0], expected, rtol=0, atol=1e-13)


def test_it_starts_at_the_first_value_without_a_jump():
    assert filtered([[4.0, -2.0]] * 5).tolist() == [[4.0, -2.0]] * 5


def test_an_element_that_is_missing_stays_missing_and_does_not_touch_the_others():
    result = filtered([[1.0, np.nan], [1.0, np.nan], [1.0, 6.0]])
    assert result[:, 0].tolist() == [1.0, 1.0, 1.0]
    assert np.isnan(result[:2, 1]).all()
    assert result[2, 1] == 6.0
