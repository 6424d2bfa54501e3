"""The values that a robot has, from a log of it: the twin repeats the log's commands until it moves as measured."""

from drake_twin.calibration.fit import calibrate
from drake_twin.calibration.fitted import Fitted
from drake_twin.calibration.result import Result

__all__ = ["Fitted", "Result", "calibrate"]
