"""A log that a twin repeats: from where it starts, with which values, and what it measures."""

import numpy as np
import pytest
from pendulum_logs import DAMPING, MASS, STATE_TOPIC, messages, motion, pendulum, write_log

from drake_twin import Twin
from drake_twin.calibration.log import read_bag
from drake_twin.calibration.simulated import SimulatedLog

TRUTH = {"pendulum.arm.mass": MASS, "pendulum.hinge.damping": DAMPING}


@pytest.fixture(scope="module")
def simulated(tmp_path_factory):
    folder = tmp_path_factory.mktemp("log")
    scenario = pendulum(folder)
    with Twin(scenario) as twin:
        log = read_bag(write_log(folder / "log", messages(duration=0.6)), twin.graph.endpoints, {})
    found = SimulatedLog(scenario, log, 0.0)
    yield found
    found.close()


def positions(simulated, values, moved=None):
    series = simulated.run(values, moved or {})[STATE_TOPIC]
    (name,) = (name for name in series if "position" in name)
    return series[name]


def test_with_the_true_values_it_moves_as_the_equation_of_motion(simulated):
    times, values = positions(simulated, TRUTH)
    at, truth, *_ = motion(0.6)
    within = times <= at[-1]
    assert values[within] == pytest.approx(np.interp(times[within], at, truth), abs=2e-3)
    assert np.ptp(values[within]) > 0.05


def test_it_may_begin_elsewhere_and_begins_at_home_again(simulated):
    (_, home), (_, moved), (_, again) = (positions(simulated, TRUTH, start) for start in ({}, {"hinge": 0.25}, {}))
    assert moved[0] - home[0] == pytest.approx(0.25, abs=2e-3)
    assert again == pytest.approx(home, abs=1e-5)  # of the accuracy
