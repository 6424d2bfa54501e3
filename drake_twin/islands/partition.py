"""Which movers share a plant: a pure function of where they are, and of nothing that was before."""

from collections.abc import Iterable, Sequence

import numpy as np


def components(
    lower: np.ndarray,
    upper: np.ndarray,
    owners: np.ndarray,
    rows: np.ndarray,
    numbers: Iterable[int],
    tied: Iterable[tuple[int, int]] = (),
) -> list[list[int]]:
    """Return the movers whose boxes hang together, each group in order, the groups by their first.

    Args:
        lower: The lower corners of the boxes, shape (boxes, 3).
        upper: Their upper corners.
        owners: The number of each box's mover.
        rows: The boxes that are looked at.
        numbers: The movers that are looked at, also those without a box.
        tied: Pairs that belong together wherever they are.
    """
    own = owners[rows]
    meet = ((lower[rows][:, np.newaxis] <= upper[rows]) & (upper[rows][:, np.newaxis] >= lower[rows])).all(axis=2)
    ones, others = np.nonzero(meet)
    roots = {number: number for number in numbers}

    def root(number: int) -> int:
        while roots[number] != number:
            roots[number] = roots[roots[number]]
            number = roots[number]
        return number

    is_pair = ones < others
    pairs = [*zip(own[ones[is_pair]].tolist(), own[others[is_pair]].tolist(), strict=True)]
    for one, other in [*pairs, *tied]:
        if one in roots and other in roots:
            first, second = sorted((root(one), root(other)))
            roots[second] = first
    found: dict[int, list[int]] = {}
    for number in sorted(roots):
        found.setdefault(root(number), []).append(number)
    return list(found.values())


def after_blows(parts: Sequence[Sequence[int]], owners: np.ndarray, speeds: np.ndarray) -> np.ndarray:
    """Return how much faster each box may be than it is (m/s), shape (boxes,), where one may hit another one.

    What is hit by something much heavier leaves it with twice its speed at most.

    Args:
        parts: The movers that may touch each other.
        owners: The number of each box's mover.
        speeds: The speed of each box (m/s).
    """
    faster = np.zeros(len(speeds))
    for part in parts:
        if len(part) > 1:
            own = np.isin(owners, part)
            faster[own] = 2.0 * speeds[own].max(initial=0.0) - speeds[own]
    return faster


def touched(lower: np.ndarray, upper: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return which boxes meet one of some boxes, shape (boxes,); those themselves do."""
    meets: np.ndarray = (
        ((lower[rows][:, np.newaxis] <= upper) & (upper[rows][:, np.newaxis] >= lower)).all(axis=2).any(axis=0)
    )
    return meets


def packed(parts: Sequence[Sequence[int]], most: int) -> list[tuple[int, ...]]:
    """Put components into groups of at most so many movers, in their order; a larger component is a group of its own.

    Each step of a plant has a cost of its own, so that robots that are alone do not get a plant each.
    """
    groups: list[list[int]] = []
    for part in parts:
        if groups and len(groups[-1]) + len(part) <= most:
            groups[-1] += part
        else:
            groups.append(list(part))
    return [tuple(sorted(group)) for group in groups]
