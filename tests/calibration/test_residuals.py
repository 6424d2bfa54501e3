"""What a log leaves open, found at each comparison: delays, and the frame that poses are in."""

import numpy as np
import pytest
from scipy.optimize import minimize

from drake_twin.calibration.log import Log, LoggedCommand, Measured
from drake_twin.calibration.residuals import Comparison

TIMES = np.arange(0, 2, 0.05)
MORE_TIMES = np.arange(-0.2, 2.2, 0.005)


def compared(series, noise, longest_delay=0.0):
    """A comparison with a log that has some numbers of one topic."""
    log = Log("log", (LoggedCommand(0.0, "/c", [1.0]),), (Measured("/pose", "/pose", series),))
    return Comparison([log], noise, [{}], longest_delay)


@pytest.mark.parametrize("late", [0.03, -0.05])
def test_a_topic_that_is_late_has_a_delay_above_zero(late):
    """Its error is that of a straight line's offset: the noise over the root of the sum of squared speeds."""
    comparison = compared({"linear.x": (TIMES, np.sin(3 * (TIMES - late)))}, {"linear": 0.01}, 0.1)
    simulated = [{"/pose": {"linear.x": (MORE_TIMES, np.sin(3 * MORE_TIMES))}}]
    found = comparison.compare(simulated)
    assert found.delays == pytest.approx([late], abs=1e-5)
    assert np.abs(found.residuals).max() < 0.1
    speeds = 3 * np.cos(3 * (TIMES - late))
    expected = 0.01 / np.linalg.norm(speeds)
    assert comparison.delay_errors(simulated, found.delays) == pytest.approx([expected], rel=1e-2)


@pytest.mark.parametrize("of_angles", [0.002, 0.01, 0.05])
def test_headings_and_places_tell_the_frame_by_their_noise(of_angles):
    """Against SciPy's minimum over turn and offset, where a compass and a camera differ by 0.1 rad."""
    of_places = 0.01
    x, y, yaw = np.sin(TIMES), 0.5 * TIMES, np.cos(TIMES)
    turned = np.cos(0.4) * x - np.sin(0.4) * y, np.sin(0.4) * x + np.cos(0.4) * y
    series = {"x": (TIMES, turned[0] + 3.0), "y": (TIMES, turned[1] - 1.0), "yaw": (TIMES, yaw + 0.5)}
    comparison = compared(series, {"place": of_places, "angle": of_angles})
    found = comparison.compare([{"/pose": {"x": (TIMES, x), "y": (TIMES, y), "yaw": (TIMES, yaw)}}]).residuals

    def residuals(frame):
        turn, *offset = frame
        moved = np.cos(turn) * x - np.sin(turn) * y + offset[0], np.sin(turn) * x + np.cos(turn) * y + offset[1]
        places = [(series[name][1] - own) / of_places for name, own in zip("xy", moved, strict=True)]
        return np.concatenate([*places, (series["yaw"][1] - yaw - turn) / of_angles])

    least = minimize(lambda frame: float(residuals(frame) @ residuals(frame)), [0.45, 3.0, -1.0], tol=1e-12)
    assert 0.4 < least.x[0] < 0.5
    assert found == pytest.approx(residuals(least.x), abs=0.02 * np.abs(residuals(least.x)).max())
