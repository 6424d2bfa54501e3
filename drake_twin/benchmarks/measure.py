"""Timing side by side: machines drift, so what is compared runs by turns, and medians and ratios are quoted."""

import gc
from collections.abc import Callable, Mapping
from statistics import median
from time import perf_counter


def by_turns(cases: Mapping[str, Callable[[], object]], repeats: int) -> dict[str, list[float]]:
    """Wall times (s) of cases that run one after the other, again and again.

    Args:
        cases: name → what is timed.
        repeats: how often each runs.
    """
    times: dict[str, list[float]] = {name: [] for name in cases}
    for _ in range(repeats):
        for name, case in cases.items():
            gc.collect()
            begin = perf_counter()
            case()
            times[name].append(perf_counter() - begin)
    return times


def ratio(times: Mapping[str, list[float]], name: str, other: str) -> float:
    """The median over the turns of one case's time in the other's."""
    return median(a / b for a, b in zip(times[name], times[other], strict=True))
