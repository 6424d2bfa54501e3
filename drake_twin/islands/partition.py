"""Which movers share a plant: a pure function of where they are, and of nothing that was before."""

from collections.abc import Iterable, Sequence

import numpy as np


def components(
    lower: np.ndarray, upper: np.ndarray, owners: np.ndarray, count: int, tied: Iterable[tuple[int, int]] = ()
) -> list[list[int]]:
    """Return the movers whose boxes hang together, each group in order, the groups by their first.

    Args:
        lower: The lower corners of the boxes, shape (boxes, 3).
        upper: Their upper corners.
        owners: The number of each box's mover.
        count: How many movers there are.
        tied: Pairs that belong together wherever they are.
    """
    roots = list(range(count))

    def root(number: int) -> int:
        while roots[number] != number:
            roots[number] = roots[roots[number]]
            number = roots[number]
        return number

    meet = np.ones((len(owners), len(owners)), dtype=bool)
    for axis in range(3):
        meet &= lower[:, np.newaxis, axis] <= upper[np.newaxis, :, axis]
    meet &= meet.T
    ones, others = np.nonzero(np.triu(meet, 1))
    for one, other in [*zip(owners[ones].tolist(), owners[others].tolist(), strict=True), *tied]:
        first, second = sorted((root(one), root(other)))
        roots[second] = first
    found: dict[int, list[int]] = {}
    for number in range(count):
        found.setdefault(root(number), []).append(number)
    return list(found.values())


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
