"""The option ``--time-step``: a number of seconds, or the longest step with which the scenario moves alike."""

import argparse
import sys
from dataclasses import replace
from typing import Any

from drake_twin.program import say
from drake_twin.scenario import Scenario


class _TimeStep(argparse.Action):
    """Tells ``auto`` and ``auto:ERROR`` from a number of seconds."""

    def __call__(self, parser: Any, namespace: Any, values: Any, option_string: Any = None) -> None:
        is_auto = values == "auto" or values.startswith("auto:")
        try:
            number = None if values == "auto" else float(values.removeprefix("auto:"))
        except ValueError:
            valid = "valid are seconds, auto, and auto:ERROR with the largest error in m or rad"
            parser.error(f"{option_string} {values}: {valid}")
        namespace.time_step = None if is_auto else number
        namespace.auto_step = is_auto
        namespace.auto_step_error = number if is_auto else None


def add_time_step(group: argparse._ArgumentGroup) -> None:
    """Add ``--time-step``, which gives ``time_step`` (s), or ``auto_step`` and ``auto_step_error`` (m or rad)."""
    group.add_argument(
        "--time-step",
        action=_TimeStep,
        metavar="S",
        help="physics step (default: 0.001); auto, auto:ERROR: the longest with which it moves as with 0.001, within an"
        " error (default: 0.01 m or rad) in its first second",
    )
    group.set_defaults(auto_step=False, auto_step_error=None)


def with_longest_step(scenario: Scenario, options: argparse.Namespace) -> Scenario:
    """Return the scenario with the longest step with which it moves alike, and say it."""
    from drake_twin.builder.longest_step import ERROR, TIME, longest_step

    time = TIME if options.duration is None else min(TIME, options.duration)
    found = longest_step(scenario, error=options.auto_step_error or ERROR, duration=time)
    say(str(found), sys.stderr)
    return replace(scenario, time_step=found.time_step)
