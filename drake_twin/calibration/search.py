"""The search: a screen of the whole range, least squares from its best points, evolution where these fail.

Least squares alone ends in a wrong place where wheels slip, and is sure of it; a global search alone takes ten times as
many episodes where a robot moves smoothly.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from drake_twin.calibration.evaluations import Evaluation, Evaluations, Point, Stopped

FITS = 1.5  # χ²/dof above which the twin does not move as the log says

_STEP = 0.01  # of the range: smaller steps see only the noise of contact
_FAR = 0.25  # of the range: how far apart two starts are at least
_MORE_DESCENTS = 3
_LEAST_GAIN = 1e-4  # of χ², below which least squares ends
_LARGEST_POPULATION = 7  # members per value
_SIMPLEX = 0.05  # of the range: the first simplex of the last descent


def search(evaluations: Evaluations, method: str, start: Point | None) -> list[Evaluation]:
    """Search the ranges.

    Args:
        evaluations: Simulates points; it keeps all of them.
        method: One of `METHODS`.
        start: A first guess, if there is one.

    Returns:
        Where the descents of the search ended.

    Raises:
        Stopped: If it was stopped before the first simulation.
    """
    ends: list[Evaluation] = []
    try:
        METHODS[method](evaluations, start, ends)
    except Stopped:
        if not evaluations.every:
            raise
        ends = ends or [evaluations.best]
    return ends


def _auto(evaluations: Evaluations, start: Point | None, ends: list[Evaluation]) -> None:
    _screened_descents(evaluations, start, ends)
    if _is_poor(evaluations, ends):
        for one in _screen(evaluations, 8 * len(evaluations.fitted))[:_MORE_DESCENTS]:
            ends.append(_least_squares(evaluations, one.point))
            if not _is_poor(evaluations, ends):
                return
        _evolution(evaluations, start, ends)


def _is_poor(evaluations: Evaluations, ends: Sequence[Evaluation]) -> bool:
    return min(end.cost for end in ends) > FITS * evaluations.freedom


def _screened_descents(evaluations: Evaluations, start: Point | None, ends: list[Evaluation]) -> None:
    screened = _screen(evaluations, 2 * len(evaluations.fitted))
    first = evaluations.at(start) if start is not None else screened[0]
    ends.append(_least_squares(evaluations, first.point))
    for other in screened:
        if all(np.abs(other.point - known).max() > _FAR for known in (first.point, ends[0].point)):
            ends.append(_least_squares(evaluations, other.point))
            return


def _descent(evaluations: Evaluations, start: Point | None, ends: list[Evaluation]) -> None:
    middle = np.full(len(evaluations.fitted), 0.5)
    ends.append(_least_squares(evaluations, middle if start is None else start))


def _evolution(evaluations: Evaluations, start: Point | None, ends: list[Evaluation]) -> None:
    """Differential evolution from the best points so far, then a descent without derivatives."""
    from scipy.optimize import differential_evolution, minimize

    count = len(evaluations.fitted)
    size = max(5, _LARGEST_POPULATION * count)
    if len(evaluations.every) < size:
        _screen(evaluations, size - len(evaluations.every))
    members = sorted(evaluations.every, key=lambda item: item.cost)[:size]
    polish = 60 * count  # episodes that are kept for the last descent
    generations = max(1, (evaluations.left - polish) // size)

    def cost(point: Point) -> float:
        return evaluations.at(point).cost

    differential_evolution(
        cost,
        [(0.0, 1.0)] * count,
        init=np.array([item.point for item in members]),
        maxiter=generations,
        tol=0.0,
        atol=1.0,  # of χ²
        polish=False,
        rng=0,
    )
    best = evaluations.best.point
    simplex = [best, *(best + np.where(best < 0.5, _SIMPLEX, -_SIMPLEX) * row for row in np.eye(count))]
    minimize(
        cost,
        best,
        method="Nelder-Mead",
        bounds=[(0.0, 1.0)] * count,
        options={"initial_simplex": np.array(simplex), "maxfev": polish, "xatol": 1e-4, "fatol": 0.1},
    )
    ends.append(evaluations.best)


def _screen(evaluations: Evaluations, size: int) -> list[Evaluation]:
    """Simulate at least so many points of Sobol's sequence; return them, the best first."""
    from scipy.stats import qmc

    count = len(evaluations.fitted)
    power = max(3, int(np.ceil(np.log2(size))))
    points = qmc.Sobol(count, rng=0).random_base2(power)
    return sorted(map(evaluations.at, points), key=lambda item: item.cost)


def _least_squares(evaluations: Evaluations, start: Point) -> Evaluation:
    """Descend from a point by least squares; return the end.

    The derivatives are taken over steps of a hundredth of the range at the start, and then mended by what each further
    simulation tells (Broyden), which takes a third of the episodes of differences at each step.
    """
    from scipy.optimize import least_squares

    inside = np.clip(start, 1e-3, 1.0 - 1e-3)
    slopes = _Slopes(evaluations)
    found = least_squares(
        lambda point: evaluations.at(point).residuals,
        inside,
        jac=slopes,
        bounds=(0.0, 1.0),
        ftol=_LEAST_GAIN,
        xtol=1e-4,
        gtol=float(np.finfo(float).eps),  # where nothing has an effect at all
        x_scale=1.0,
        max_nfev=20,
    )
    return evaluations.at(found.x)


class _Slopes:
    """The derivatives of the residuals along a descent."""

    def __init__(self, evaluations: Evaluations):
        self._evaluations = evaluations
        self._slopes: np.ndarray | None = None
        self._here: Evaluation | None = None
        self._seen = 0

    def __call__(self, point: Point) -> np.ndarray:
        here = self._evaluations.at(point)
        if self._slopes is None or self._here is None:
            self._slopes = self._evaluations.jacobian(point, [_STEP] * len(point))
        else:
            tried = [*self._evaluations.every[self._seen :], self._here]
            for other in sorted(tried, key=lambda item: -float(np.abs(item.point - here.point).max())):
                step = other.point - here.point
                if (length := float(step @ step)) > 1e-12:
                    self._slopes = self._slopes + np.outer(
                        (other.residuals - here.residuals - self._slopes @ step) / length, step
                    )
        self._here, self._seen = here, len(self._evaluations.every)
        return self._slopes


METHODS: Mapping[str, Callable[[Evaluations, Point | None, list[Evaluation]], None]] = {
    "auto": _auto,
    "least-squares": _descent,
    "sobol": _screened_descents,
    "evolution": _evolution,
}
