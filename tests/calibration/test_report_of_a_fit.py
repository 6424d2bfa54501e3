"""What a calibration says of its result, line by line."""

import numpy as np
import pytest

from drake_twin.calibration.fitted import Fitted
from drake_twin.calibration.report import report
from drake_twin.calibration.result import Result
from drake_twin.scenario import Robot, Scenario

FITTED = (Fitted("r.mass", 0.5, 2.0), Fitted("friction", 0.1, 1.0))


def result(**given):
    plain = {
        "fitted": FITTED,
        "values": {"r.mass": 1.25},
        "errors": {"r.mass": 0.031},
        "unknown": ("friction",),
        "directions": (("r.mass",), ("r.mass", "friction")),
        "correlation": np.array([[1.0, 0.95], [0.95, 1.0]]),
        "chi_squared": 1.05,
        "chi_squared_before": 22.0,
        "held_out": (20.0, 1.1),
        "delays": (),
        "minima": (),
        "episodes": 42,
        "problems": (),
        "notes": (),
        "curves": (),
        "scenario": Scenario((Robot("r", "r.urdf"),)),
    }
    return Result(**plain | given)


def test_values_have_their_errors_and_unknown_ones_are_said():
    lines = report(result()).splitlines()
    assert lines[0] == "42 episodes, χ²/dof 1.050 (22 with the scenario's own values)"
    assert lines[1] == "  r.mass    1.25 ± 0.031  (searched 0.5 to 2)"
    assert lines[2] == "  friction  not known from these logs: the scenario's own value stays"
    assert "the logs do not tell apart: r.mass, friction" in lines
    assert sum("do not tell apart" in line for line in lines) == 1


@pytest.mark.parametrize(("error", "is_known"), [(0.004, True), (8.0, True), (12.0, False)])
def test_a_delay_of_which_the_log_says_nothing_is_not_given(error, is_known):
    text = report(result(delays=(("/s", 0.05, error),)))
    assert ("/s is 50.00 ± " in text) is is_known
    assert ("how late /s is cannot be known" in text) is not is_known
