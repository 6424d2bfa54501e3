"""A robot's clock is matched to the listener's, with offset, drift and delays that nobody knows."""

import numpy as np
import pytest

from drake_twin.mirror.clock_match import Arrivals, ClockMatch


def heard(clock, generator, times, offset=0.2, drift=100e-6, delay=0.001, jitter=0.002):
    """Let a clock hear stamps of these true times; return by how much each is found wrongly (s)."""
    errors = []
    for time in times:
        received = time + delay + generator.exponential(jitter)
        errors.append(clock.heard(received, time * (1 + drift) + offset) - time)
    return np.array(errors)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(("offset", "drift"), [(0.2, 100e-6), (-0.2, -100e-6), (1e6, 0.0), (-3.0, 40e-6)])
def test_offset_and_drift_are_found_to_two_milliseconds(seed, offset, drift):
    clock = ClockMatch()
    errors = heard(clock, np.random.default_rng(seed), np.arange(100, 220, 0.02), offset, drift)
    assert np.abs(errors[1000:]).max() < 2e-3
    assert clock.drift == pytest.approx(-drift, abs=10e-6)
    assert clock.resets == 0


def test_a_message_is_never_stamped_after_it_was_heard():
    generator, clock = np.random.default_rng(1), ClockMatch()
    for index in range(2000):
        time = 0.02 * index
        received = time + generator.exponential(0.05)
        assert clock.heard(received, time) <= received


def test_a_clock_that_is_set_is_found_again_and_one_stray_stamp_is_not_a_new_clock():
    generator, clock = np.random.default_rng(2), ClockMatch()
    heard(clock, generator, np.arange(0, 20, 0.02), drift=0.0)
    assert clock.heard(20.001, 1.0) == 20.001
    assert np.abs(heard(clock, generator, np.arange(20.02, 30, 0.02), drift=0.0)).max() < 0.03
    assert clock.resets == 0
    errors = heard(clock, generator, np.arange(30, 40, 0.02), offset=-5.0, drift=0.0)
    assert clock.resets == 1
    assert np.abs(errors[50:]).max() < 3e-3


def test_gaps_repetitions_and_what_comes_too_late_are_counted():
    arrivals = Arrivals()
    for time in (*np.arange(0, 1, 0.02), 0.5, 0.98, *np.arange(2, 3, 0.02)):
        arrivals.add(float(time))
    assert (arrivals.late, arrivals.repeated, arrivals.gaps) == (1, 1, 1)
    assert arrivals.longest_gap == pytest.approx(1.02)
    assert arrivals.period == pytest.approx(0.02)
