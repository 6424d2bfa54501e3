"""Names for which a noise is given: kinds of numbers, or numbers of the logs."""

import numpy as np
import pytest

from drake_twin.calibration.log import Measured
from drake_twin.calibration.noise import check_names, noises
from drake_twin.errors import InputError

TIMES = np.arange(0, 4, 0.02)


def test_kinds_and_numbers_of_the_logs_are_names():
    check_names({"position": 0.1, "hinge.position": 0.2}, {"hinge.position"})
    check_names({}, set())
    with pytest.raises(InputError, match=r"the logs have no such number.*Did you mean 'hinge.position'"):
        check_names({"position": 0.1, "hinge.positio": 0.2}, {"hinge.position"})


def test_a_numbers_own_noise_comes_before_that_of_its_kind_and_this_before_an_estimate():
    generator = np.random.default_rng(2)
    series = {
        f"{joint}.{kind}": (TIMES, np.sin(TIMES) + generator.normal(0, 0.01, len(TIMES)))
        for joint in ("a", "b")
        for kind in ("position", "velocity")
    }
    found = noises(Measured("/s", "/s", series), {"a.position": 0.5, "position": 0.3})
    assert (found["a.position"], found["b.position"]) == (0.5, 0.3)
    assert found["a.velocity"] == found["b.velocity"] == pytest.approx(0.01, rel=0.2)


@pytest.mark.parametrize(("numbers", "expected"), [([0.0, 1.0, 0.5], 1e-4), ([0.0, 1.0, 0.5, 2.0], 1.1603)])
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_three_measurements_say_nothing_of_the_noise_and_four_have_one_third_difference(numbers, expected):
    """It is 3.5 here; that of noise has the standard deviation √20 σ and the median 0.6745 of it."""
    series = {"a.position": (0.02 * np.arange(len(numbers)), np.array(numbers))}
    found = noises(Measured("/s", "/s", series), {})
    assert found["a.position"] == pytest.approx(expected, rel=1e-3)
