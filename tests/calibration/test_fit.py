"""`drake_twin.calibration.calibrate`: how many episodes it takes, and what it notes of its ranges."""

import re

import numpy as np
import pytest
from pendulum_logs import DAMPING, MASS, TOPIC, pendulum

from drake_twin import Twin
from drake_twin.calibration import Fitted, calibrate
from drake_twin.errors import InputError

ARM, HINGE = "pendulum.arm.mass", "pendulum.hinge.damping"


@pytest.fixture(scope="module")
def scenario(tmp_path_factory):
    return pendulum(tmp_path_factory.mktemp("pendulum"), values={HINGE: DAMPING})


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    with Twin(pendulum(tmp_path_factory.mktemp("recorded"), values={ARM: MASS, HINGE: DAMPING})) as twin:
        twin.recorder.begin()
        twin.publish(TOPIC, [1.0])
        twin.advance_to(0.3)
        twin.publish(TOPIC, [-1.5])
        twin.advance_to(0.6)
        return twin.recorder.recording()


def test_the_least_number_of_episodes_that_is_named_suffices(scenario, recording):
    fitted = [Fitted(ARM, 1.0, 3.0)]
    with pytest.raises(InputError, match="3 episodes are too few to fit 1 values") as refused:
        calibrate(scenario, [recording], fitted, most_episodes=3, method="least-squares")
    least = int(re.search(r"it takes (\d+) or more", str(refused.value))[1])
    with pytest.raises(InputError, match=f"it takes {least} or more"):
        calibrate(scenario, [recording], fitted, most_episodes=least - 1, method="least-squares")
    result = calibrate(scenario, [recording], fitted, most_episodes=least, method="least-squares")
    assert 3 < result.episodes <= least
    assert result.errors[ARM] > 0


@pytest.mark.parametrize(("low", "high", "is_at_end"), [(1.0, 1.5, True), (1.9, 3.0, True), (1.0, 3.0, False)])
def test_a_value_at_the_end_of_its_range_is_noted(scenario, recording, low, high, is_at_end):
    result = calibrate(scenario, [recording], [Fitted(ARM, low, high)], method="least-squares")
    assert (f"{ARM} is at the end of its range: the value may be outside" in result.notes) is is_at_end
    assert min(max(MASS, low), high) == pytest.approx(result.values[ARM], rel=1e-3)
    for curve in result.curves:  # the pendulum's file has a mass of 1 kg
        (times, measured), span = curve.measured, np.ptp(curve.measured[1])
        assert curve.before.shape == curve.after.shape == measured.shape == times.shape
        assert np.abs(curve.before - measured).max() > 0.1 * span
        assert (np.abs(curve.after - measured).max() < 0.01 * span) is not is_at_end
