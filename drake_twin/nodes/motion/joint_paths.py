"""Paths between joint positions without contact.

RRT-Connect (Kuffner and LaValle 2000) with shortcuts; with constraints along the path, each position is projected onto
them (Berenson et al. 2009). All random numbers follow from one seed, and a search ends after a number of looks, not
after a time, so that a plan is the same each time.
"""

from collections.abc import Callable, Sequence

import numpy as np

_STEP = 0.05  # rad or m, of the joint that moves the most, between two looks
_REACH = 0.5  # how far one extension of a tree goes, in the same measure
_SHORTCUTS = 100

Valid = Callable[[np.ndarray], bool]
Project = Callable[[np.ndarray], np.ndarray | None]


def plan_path(
    start: np.ndarray,
    goals: Sequence[np.ndarray],
    is_valid: Valid,
    sample: Callable[[np.random.Generator], np.ndarray],
    looks: int,
    project: Project | None = None,
) -> list[np.ndarray] | None:
    """Return a path from a start to the first goal that can be reached; None without one.

    Args:
        start: Positions (rad or m), shape (n,), which are valid.
        goals: Positions to end at, each shape (n,), which are valid.
        is_valid: Tells whether positions are free of contact and meet the constraints.
        sample: Returns random positions.
        looks: How often `is_valid` may be asked in the search.
        project: Returns positions near given ones that meet the constraints along the path.
    """
    search = _Search(is_valid, looks, project)
    sampler = np.random.default_rng(0)
    for goal in goals:
        if (path := search.straight(start, goal)) is not None:
            return path
    for goal in goals:
        path = search.connect(start, goal, sample, sampler)
        if path is not None:
            return search.shortened(path, sampler)
    return None


class _Search:
    def __init__(self, is_valid: Valid, looks: int, project: Project | None):
        self._is_valid, self._left, self._project = is_valid, looks, project

    def straight(self, start: np.ndarray, end: np.ndarray) -> list[np.ndarray] | None:
        """Return the straight path if it is valid, of points that are close to each other."""
        path, reached = self._towards(start, end, np.inf)
        return [start, *path] if reached else None

    def connect(
        self,
        start: np.ndarray,
        goal: np.ndarray,
        sample: Callable[[np.random.Generator], np.ndarray],
        sampler: np.random.Generator,
    ) -> list[np.ndarray] | None:
        first, last = _Tree(start), _Tree(goal)
        trees = [first, last]
        while self._left > 0:
            wanted = sample(sampler)
            if self._project is not None:
                projected = self._project(wanted)
                if projected is None:
                    self._left -= 1
                    continue
                wanted = projected
            one, other = trees
            new = self._extend(one, wanted, _REACH)
            if new is not None:
                met = self._extend(other, one.points[new], np.inf, wholly=True)
                if met is not None:
                    ends = (new, met) if one is first else (met, new)
                    return [*first.branch(ends[0]), *last.branch(ends[1])[-2::-1]]
            trees.reverse()
        return None

    def _extend(self, tree: "_Tree", wanted: np.ndarray, reach: float, *, wholly: bool = False) -> int | None:
        """Grow a tree towards positions; return the new leaf's number, None if it does not grow (wholly)."""
        near = tree.nearest(wanted)
        path, reached = self._towards(tree.points[near], wanted, reach)
        if not path or (wholly and not reached):
            return near if reached else None
        for point in path:
            near = tree.add(point, near)
        return near

    def _towards(self, start: np.ndarray, end: np.ndarray, reach: float) -> tuple[list[np.ndarray], bool]:
        path: list[np.ndarray] = []
        here = start
        gone = 0.0
        while True:
            gap = end - here
            size = float(np.abs(gap).max())
            if size < 1e-9:
                return path, True
            if gone >= reach or self._left <= 0:
                return path, False
            step = min(_STEP, size)
            there = here + gap * (step / size)
            if self._project is not None:
                projected = self._project(there)
                if projected is None or np.abs(projected - here).max() > 2 * _STEP:
                    return path, False
                if np.abs(end - projected).max() > size - 0.1 * step:
                    return path, False  # it does not come nearer
                there = projected
            self._left -= 1
            if not self._is_valid(there):
                return path, False
            path.append(there)
            here, gone = there, gone + step

    def shortened(self, path: list[np.ndarray], sampler: np.random.Generator) -> list[np.ndarray]:
        """Replace pieces of a path by straight ones where these are valid."""
        self._left = max(self._left, 20 * _SHORTCUTS)
        for _ in range(_SHORTCUTS):
            if len(path) < 3:
                break
            first, last = sorted(sampler.choice(len(path), 2, replace=False).tolist())
            if last - first < 2:
                continue
            piece = self.straight(path[first], path[last])
            if piece is not None and len(piece) < last - first + 1:
                path[first : last + 1] = piece
        return path


class _Tree:
    def __init__(self, root: np.ndarray):
        self.points = [root]
        self._parents = [-1]

    def nearest(self, wanted: np.ndarray) -> int:
        return int(np.abs(np.array(self.points) - wanted).max(axis=1).argmin())

    def add(self, point: np.ndarray, parent: int) -> int:
        self.points.append(point)
        self._parents.append(parent)
        return len(self.points) - 1

    def branch(self, leaf: int) -> list[np.ndarray]:
        """Return the points from the root to a leaf."""
        found = []
        while leaf >= 0:
            found.append(self.points[leaf])
            leaf = self._parents[leaf]
        return found[::-1]
