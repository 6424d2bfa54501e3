"""In place of a twin: formulas of the values, whose fits have closed forms."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from drake_twin.calibration.evaluations import Evaluations
from drake_twin.calibration.fitted import Fitted
from drake_twin.calibration.log import Log, LoggedCommand, Measured
from drake_twin.calibration.residuals import Comparison

TIMES = np.arange(0, 2, 0.02)


class Formula:
    """What is measured is a formula of the times and the values."""

    def __init__(self, formula: Callable[..., np.ndarray]):
        self.formula = formula

    def run(self, values, moved=None):
        times = np.arange(0, 2.1, 0.005)
        return {"/odom": {"linear.x": (times, self.formula(times, *values.values()))}}


def evaluations(
    formula: Callable[..., np.ndarray],
    truth: Sequence[float],
    fitted: Sequence[Fitted],
    sigma: float = 0.01,
    most: int = 1000,
    given: Mapping[str, float] | None = None,
) -> Evaluations:
    """The evaluations of a log of 2 s, measured with noise, which is given unless ``given`` says otherwise."""
    values = formula(TIMES, *truth) + np.random.default_rng(1).normal(0, sigma, len(TIMES))
    measured = Measured("/odom", "/odom", {"linear.x": (TIMES, values)})
    log = Log("log", (LoggedCommand(0.0, "/c", [1.0]),), (measured,))
    comparison = Comparison([log], {"linear": sigma} if given is None else given, [{}], 0.0)
    return Evaluations(fitted, [Formula(formula)], comparison, most)
