"""How certain the values are: a quadratic through samples near the best point, and the spread of the restarts.

Derivatives of the residuals over tiny steps make errors 500 times too small where wheels slip: χ² is rough there. So
each value is varied to both sides by about its own error; how far χ² is from a quadratic there counts as what the log
cannot tell.
"""

from collections.abc import Sequence

import numpy as np

from drake_twin.calibration.evaluations import Evaluation, Evaluations
from drake_twin.dataclass import dataclass

_LEAST_STEP, _LARGEST_STEP = 2e-3, 0.1  # of the range
_UNIFORM = 12**-0.5  # the standard deviation of a value of which only the range is known
_UNKNOWN = 0.5  # of this: an error from which on the log says nothing about a value
_PART = 0.3  # a value's part in a direction from which on it is named
_SAME_PLACE = 0.03  # of the range: ends of descents that are closer are the same
_ROUNDS = 3  # at most, in which the best point is mended


@dataclass(frozen=True)
class Certainty:
    """How certain a point is.

    Attributes:
        best: The point.
        slopes: Derivatives of the residuals by the shares, shape (N, p).
        errors: Standard error of each share, shape (p,).
        correlation: Shape (p, p).
        unknown: Which shares the log does not tell, shape (p,).
        directions: The combinations that it does not tell: the indices of their values.
        delay_errors: Standard error of each delay because of those of the values (s).
        others: Ends of descents that are as good, and elsewhere.
    """

    best: Evaluation
    slopes: np.ndarray
    errors: np.ndarray
    correlation: np.ndarray
    unknown: np.ndarray
    directions: tuple[tuple[int, ...], ...]
    delay_errors: np.ndarray
    others: tuple[Evaluation, ...]


def points_of(size: int) -> int:
    """Return how many points `certainty` needs at least, for a number of values."""
    return 2 * size + 2


def certainty(evaluations: Evaluations, ends: Sequence[Evaluation]) -> Certainty:
    """Return the certainty of the best point, which is mended where the samples around it show a better one.

    Raises:
        Stopped: If the search has to end.
    """
    best = min((*ends, evaluations.best), key=lambda item: item.cost)
    steps = np.full(len(best.point), 0.01)
    for _ in range(_ROUNDS):
        slopes, curvature, rough, delay_slopes = _around(evaluations, best, steps)
        normal = slopes.T @ slopes
        better = evaluations.at(
            best.point - np.linalg.solve(normal + 12 * np.eye(len(steps)), slopes.T @ best.residuals)
        )
        moved = best.cost - better.cost
        if better.cost < best.cost:
            best = better
        wanted = np.clip(1.0 / np.sqrt(np.maximum(np.diag(normal), 1e-12)), _LEAST_STEP, _LARGEST_STEP)
        if moved < max(0.5, 0.01 * best.cost) and np.all((wanted < 4 * steps) & (steps < 4 * wanted)):
            break
        if evaluations.left < points_of(len(steps)) + 2:
            break
        steps = wanted
    scale = max(1.0, best.cost / evaluations.freedom) + rough
    ratio = np.sqrt(np.clip(curvature / np.maximum(np.diag(normal), 1e-12), 1e-3, 1.0))
    information = normal * np.outer(ratio, ratio) / scale
    covariance = np.linalg.inv(information + np.eye(len(steps)) / _UNIFORM**2)
    deviations = np.sqrt(np.diag(covariance))
    unknown = deviations > _UNKNOWN * _UNIFORM
    apart = np.where(unknown, np.inf, np.maximum(6 * deviations, _SAME_PLACE))
    as_good = [end for end in ends if end.cost <= best.cost + scale]
    elsewhere = [bool(np.any(np.abs(end.point - best.point) > apart)) for end in as_good]
    near = [end.point for end, is_other in zip(as_good, elsewhere, strict=True) if not is_other]
    spread = np.std([best.point, *near], axis=0)
    errors = np.sqrt(deviations**2 + np.where(unknown, 0.0, spread) ** 2)
    values, vectors = np.linalg.eigh(information)
    vague = [vectors[:, i] for i, value in enumerate(values) if value < (_UNKNOWN * _UNIFORM) ** -2]
    return Certainty(
        best,
        slopes,
        errors,
        covariance / np.outer(deviations, deviations),
        unknown,
        tuple(tuple(np.flatnonzero(np.abs(vector) > _PART).tolist()) for vector in vague),
        np.sqrt(np.einsum("ti,ij,tj->t", delay_slopes, covariance, delay_slopes)),
        tuple(end for end, is_other in zip(as_good, elsewhere, strict=True) if is_other),
    )


def _around(
    evaluations: Evaluations, best: Evaluation, steps: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
    """Simulate each value a step to both sides.

    Returns:
        The derivatives of the residuals; the curvature of χ² / 2 by each share; by how much χ² differs from the
        quadratic of the derivatives; the derivatives of the delays.
    """
    count = len(steps)
    slopes = np.zeros((len(best.residuals), count))
    delays = np.zeros((len(best.delays), count))
    curvature = np.zeros(count)
    rough = []
    for index, step in enumerate(steps):
        row = np.eye(count)[index] * step
        up, down = evaluations.at(best.point + row), evaluations.at(best.point - row)
        width = up.point[index] - down.point[index]
        slopes[:, index] = (up.residuals - down.residuals) / width
        delays[:, index] = (up.delays - down.delays) / width
        linear = 2 * float(slopes[:, index] @ best.residuals)
        square = float(slopes[:, index] @ slopes[:, index])
        sides = [(item.point[index] - best.point[index], item.cost - best.cost) for item in (up, down)]
        above = [(way, cost) for way, cost in sides if abs(way) > 0]
        curvature[index] = np.mean([(cost - linear * way) / way**2 for way, cost in above])
        rough += [abs(cost - linear * way - square * way**2) for way, cost in above]
    return slopes, curvature, float(np.median(rough)), delays
