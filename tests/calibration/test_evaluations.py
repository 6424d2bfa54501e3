"""Simulations at points of the ranges: each once, within the ranges, and kept when the noise is known better."""

import numpy as np
import pytest
from formulas import TIMES, evaluations

from drake_twin.calibration.evaluations import Stopped
from drake_twin.calibration.fitted import Fitted

FITTED = (Fitted("a", -1.0, 1.0), Fitted("b", -1.0, 1.0))


def line(times, offset, slope):
    return offset + slope * times


def test_beyond_the_ranges_are_their_ends():
    own = evaluations(line, (0.2, -0.4), FITTED)
    assert own.at(np.array([-0.5, 1.5])).point.tolist() == [0.0, 1.0]
    assert own.values(own.at(np.array([-0.5, 1.5])).point) == pytest.approx({"a": -1.0, "b": 1.0})


def test_a_point_is_simulated_once_and_no_point_beyond_the_most():
    own = evaluations(line, (0.2, -0.4), FITTED, most=2)
    for _ in range(3):
        own.at(np.array([0.3, 0.7]))
    assert (own.episodes, len(own.every), own.left) == (1, 1, 1)
    own.at(np.array([0.4, 0.7]))
    with pytest.raises(Stopped):
        own.at(np.array([0.5, 0.7]))
    assert own.at(np.array([0.3, 0.7])) is own.every[0]


@pytest.mark.parametrize("point", [(0.3, 0.8), (0.8, 0.3)])
def test_derivatives_of_a_line_are_those_of_its_formula(point):
    """Of measured minus simulated over the noise, by shares of ranges of length 2."""
    own = evaluations(line, (0.2, -0.4), FITTED, sigma=0.01)
    expected = -2.0 / 0.01 * np.stack([np.ones(len(TIMES)), TIMES]).T
    assert own.jacobian(np.array(point), [0.01, 0.01]) == pytest.approx(expected, rel=1e-6, abs=1e-6)


def test_evaluations_keep_their_points_when_the_noise_is_estimated_again():
    """A shaking hides the noise until a twin that shakes, too, tells it: this noise then measures each residual."""

    def shaking(times, height, speed):
        return height * np.abs(times / 0.04 % 2 - 1) + speed * times

    truth = np.array([0.6, 0.7])
    own = evaluations(shaking, (0.2, 0.4), FITTED, sigma=0.01, given={})
    points = [np.array([0.1, 0.9]), truth, np.array([0.8, 0.2])]
    before = [own.at(point).residuals for point in points]
    own.settle_noise(truth)
    assert [item.point.tolist() for item in own.every] == [point.tolist() for point in points]
    assert own.comparison.sigma(0) == pytest.approx(0.01, rel=0.3)
    for point, old in zip(points, before, strict=True):
        again = own.at(point).residuals
        assert again == pytest.approx(own.comparison.compare(own.simulate(point)).residuals)
        assert np.linalg.norm(again) > 3 * np.linalg.norm(old)
    assert own.best.point.tolist() == truth.tolist()
