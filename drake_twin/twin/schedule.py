"""The grid of physics steps, and the scenario's commands on it.

Times are met at physics steps: something due at a time happens at the first step that is not before it.
"""

from math import ceil, inf, lcm

from drake_twin.errors import InputError
from drake_twin.scenario import Command

_ROUNDING = 1e-6  # of a step: k · 0.001 differs from its literal for one k in eight
_LONGEST_WAIT = 3600.0  # for two step lengths to meet (simulated s)


def step_at(time: float, time_step: float) -> int:
    """Return the first physics step that is not before a time (s)."""
    return ceil(time / time_step - _ROUNDING)


def meeting_step(step: int, time_step: float, other: float) -> int:
    """Return the first step, from one on, that is on the grid of another step length, too.

    Args:
        step: A step.
        time_step: The length of its steps (s).
        other: The other length (s).

    Raises:
        InputError: If the two do not meet within an hour.
    """
    from fractions import Fraction  # 15 ms that few need

    old, new = (Fraction(length).limit_denominator(10**9) for length in (time_step, other))
    common = lcm(old.numerator * new.denominator, new.numerator * old.denominator)
    every = common // (old.numerator * new.denominator)  # in steps of the old length
    if every * time_step > _LONGEST_WAIT:
        raise InputError(f"a step of {other:g} s never meets the present one of {time_step:g} s")
    return -(-step // every) * every


class ScheduledCommand:
    """A scenario's command and the step at which it is next due.

    Args:
        command: What to publish when.

    Attributes:
        topic: Where it is published.
        data: What.
        published: How often it has been.
    """

    def __init__(self, command: Command):
        self.topic = command.topic
        self.data = command.data
        self.published = 0
        self._command = command

    def due_step(self, time_step: float) -> float:
        """Return the step at which it is next published; infinite when it has been for the last time."""
        if self._command.period is None:
            return inf if self.published else step_at(self._command.time, time_step)
        return step_at(self._command.time + self.published * self._command.period, time_step)

    def pass_step(self) -> None:
        """Note that it was published."""
        self.published += 1
