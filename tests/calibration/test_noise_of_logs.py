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
