"""The grid of physics steps, and the scenario's commands on it.

An event that is due at a time happens at the first step that is not before that time.
"""

from math import ceil, inf, lcm

from drake_twin.errors import InputError
from drake_twin.scenario import Command

_ROUNDING = 1e-6  # relative to a step: k · 0.001 differs from its literal for one k in eight
_LONGEST_WAIT = 3600.0  # limit for the meeting of two step lengths (simulated s)


def step_at(time: float, time_step: float) -> int:
    """Return the first physics step that is not before a time (s)."""
    return ceil(time / time_step - _ROUNDING)


def meeting_step(step: int, time_step: float, other: float) -> int:
    """Return the first step, beginning with a given one, that is also on the grid of another step length.

    Args:
        step: The first step to consider.
        time_step: The length of its steps (s).
        other: The other length (s).

    Raises:
        InputError: If the two grids do not meet within an hour.
    """
    from fractions import Fraction  # an import of 15 ms, rarely needed

    old, new = (Fraction(length).limit_denominator(10**9) for length in (time_step, other))
    common = lcm(old.numerator * new.denominator, new.numerator * old.denominator)
    every = common // (old.numerator * new.denominator)  # in steps of the old length
    if every * time_step > _LONGEST_WAIT:
        raise InputError(f"a step of {other:g} s never meets the present one of {time_step:g} s")
    return -(-step // every) * every


class ScheduledCommand:
    """A scenario's command with the step at which it is due next.

    Args:
        command: The command.

    Attributes:
        topic: Its topic.
        data: Its data.
        published: How often it has been published.
    """

    def __init__(self, command: Command):
        self.topic = command.topic
        self.data = command.data
        self.published = 0
        self._command = command

    def due_step(self, time_step: float) -> float:
        """Return the step at which it is published next; infinite after the last time."""
        if self._command.period is None:
            return inf if self.published else step_at(self._command.time, time_step)
        return step_at(self._command.time + self.published * self._command.period, time_step)

    def pass_step(self) -> None:
        """Count a publication."""
        self.published += 1
