"""Cumulative sums raise as many false alarms of white noise as the formula says, and find changes in few blocks."""

import numpy as np
import pytest

from drake_twin.mirror import cumulative_sums
from drake_twin.mirror.cumulative_sums import BLOCK, MOST, REFERENCE, CumulativeSums, false_alarm_blocks, threshold


def time_to_alarm(generator, limit, mean=0.0, longest=1_000_000):
    """The blocks until S⁺ of white noise passes a limit, by arrays alone."""
    noise = np.clip(generator.normal(mean, 1.0, longest), -MOST, MOST) - REFERENCE
    walk = np.cumsum(noise)
    sums = walk - np.minimum.accumulate(np.minimum(walk, 0.0))
    above = np.flatnonzero(sums > limit)
    return int(above[0]) + 1 if len(above) else longest


@pytest.mark.parametrize("limit", [1.0, 1.5, 2.0])
def test_false_alarms_of_white_noise_come_as_seldom_as_siegmund_says(limit):
    generator = np.random.default_rng(7)
    times = [time_to_alarm(generator, limit, longest=100_000) for _ in range(300)]
    assert np.mean(times) == pytest.approx(false_alarm_blocks(limit), rel=0.3)


@pytest.mark.parametrize(("sums", "hours"), [(30, 1.0), (40, 1.0), (40, 24.0)])
def test_the_threshold_is_where_all_sums_together_raise_one_alarm_in_the_time(sums, hours):
    limit = threshold(sums, 3600 * hours)
    assert false_alarm_blocks(limit) == pytest.approx(sums * 3600 * hours / BLOCK, rel=1e-6)


@pytest.mark.parametrize("change", [3.0, -3.0])
def test_a_change_by_three_deviations_is_found_within_a_second(change):
    generator, limit = np.random.default_rng(3), threshold(40, 3600.0)
    for _ in range(200):
        sums = CumulativeSums()
        for _ in range(10):
            sums.add(generator.normal(change, 1.0))
            if sums.highest > limit:
                break
        assert sums.highest > limit
        assert 1 <= sums.blocks <= 10


def test_one_outlier_is_not_an_alarm():
    sums = CumulativeSums()
    sums.add(1e9)
    assert sums.highest == MOST - REFERENCE < threshold(40, 3600.0)
    assert [*cumulative_sums.cumulative_sums([1e9, -1e9])][1] == (0.0, MOST - REFERENCE)
