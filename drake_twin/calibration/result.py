"""What a calibration finds."""

from collections.abc import Mapping

import numpy as np

from drake_twin.calibration.fitted import Fitted
from drake_twin.calibration.log import Series
from drake_twin.dataclass import dataclass
from drake_twin.scenario import Scenario


@dataclass(frozen=True)
class Curve:
    """A number of a log: measured, and by the twin with the file's and with the fitted values.

    Attributes:
        topic: The log's topic.
        name: The number's name.
        sigma: The noise of the measurements.
        measured: Times (s) and values.
        before: What the twin has at these times with the scenario's own values.
        after: With the fitted values.
    """

    topic: str
    name: str
    sigma: float
    measured: Series
    before: np.ndarray
    after: np.ndarray


@dataclass(frozen=True)
class Result:
    """What a calibration found.

    Attributes:
        fitted: What was searched.
        values: Path → value, of those that the logs tell.
        errors: Path → standard error.
        unknown: The paths that the logs do not tell; the scenario's own values stay.
        directions: The combinations of values that the logs do not tell apart, by their paths.
        correlation: The correlations of all fitted values, in their order.
        chi_squared: χ² over the degrees of freedom; about 1 if the twin moves as measured.
        chi_squared_before: The same with the scenario's own values.
        held_out: χ² over the number of measurements of the logs' second halves: with the scenario's own values, and
            with those of a fit to the first halves only.
        delays: Topic → delay (s) and its standard error, for each log.
        minima: Other values that are as good.
        episodes: How often a log was simulated.
        problems: Why the values are not to be trusted; empty if they are.
        notes: What of the logs was not used, and what else there is to know.
        curves: All numbers, measured and simulated.
        scenario: The scenario with the values.
    """

    fitted: tuple[Fitted, ...]
    values: Mapping[str, float]
    errors: Mapping[str, float]
    unknown: tuple[str, ...]
    directions: tuple[tuple[str, ...], ...]
    correlation: np.ndarray
    chi_squared: float
    chi_squared_before: float
    held_out: tuple[float, float]
    delays: tuple[tuple[str, float, float], ...]
    minima: tuple[Mapping[str, float], ...]
    episodes: int
    problems: tuple[str, ...]
    notes: tuple[str, ...]
    curves: tuple[Curve, ...]
    scenario: Scenario
