"""Timing side by side: a machine's speed drifts, so cases run by turns, and results are medians and ratios."""

import gc
from collections.abc import Callable, Mapping
from statistics import median
from time import perf_counter


def by_turns(
    cases: Mapping[str, Callable[[], object]], repeats: int, clock: Callable[[], float] = perf_counter
) -> dict[str, list[float]]:
    """Return the times (s) of cases that run one after the other, repeatedly.

    Args:
        cases: Name → the function to time.
        repeats: How often each runs.
        clock: What measures: wall time, or the processor time of this process.
    """
    times: dict[str, list[float]] = {name: [] for name in cases}
    for _ in range(repeats):
        for name, case in cases.items():
            gc.collect()
            begin = clock()
            case()
            times[name].append(clock() - begin)
    return times


def ratio(times: Mapping[str, list[float]], name: str, other: str) -> float:
    """Return the median over the turns of one case's time divided by the other's."""
    return median(a / b for a, b in zip(times[name], times[other], strict=True))


def whole(time: float, unit: float) -> float:
    """Round a time (s) to a whole number of units, one at least."""
    return max(1, round(time / unit)) * unit
