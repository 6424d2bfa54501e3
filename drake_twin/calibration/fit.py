"""A calibration: the search, the certainty of what it found, and what speaks against it."""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from drake_twin.calibration.certainty import Certainty, certainty, points_of
from drake_twin.calibration.evaluations import Evaluations, Stopped
from drake_twin.calibration.fitted import Fitted
from drake_twin.calibration.log import Log, read_bag, without
from drake_twin.calibration.noise import check_names
from drake_twin.calibration.residuals import Comparison
from drake_twin.calibration.result import Curve, Result
from drake_twin.calibration.search import FITS, METHODS, search
from drake_twin.calibration.simulated import SimulatedLog, with_values
from drake_twin.errors import InputError, RunError
from drake_twin.scenario import Scenario
from drake_twin.twin.recording import Recording
from drake_twin.twin.twin import Twin

LONGEST_DELAY = 0.1  # s
MOST_EPISODES = 700


def calibrate(
    scenario: Scenario,
    logs: Sequence[str | Path | Recording],
    fitted: Sequence[Fitted],
    *,
    noise: Mapping[str, float] | None = None,
    renamed: Mapping[str, str] | None = None,
    left_out: Sequence[str] = (),
    longest_delay: float = LONGEST_DELAY,
    start: Mapping[str, float] | None = None,
    method: str = "auto",
    most_episodes: int = MOST_EPISODES,
    stopped: Sequence[object] = (),
    tell: bool = False,
) -> Result:
    """Find the values with which a twin moves as logs say.

    Args:
        scenario: The twin. Its commands are those of the logs, and its joints begin where the logs do.
        logs: rosbag2 bags, or recordings of a twin.
        fitted: What to search, and where.
        noise: Kind or name of a number → the standard deviation of its measurements; the others are estimated.
        renamed: Topic of a log → topic of the twin, where they differ.
        left_out: Topics and numbers of the logs to leave out.
        longest_delay: The largest delay of a topic to look for (s).
        start: Path → where to begin; by default what the scenario's ``values`` have.
        method: ``auto``, ``least-squares``, ``sobol`` or ``evolution``.
        most_episodes: How often a log may be simulated.
        stopped: Ends the search when there is something in it.
        tell: Whether to print the progress.

    Raises:
        InputError: If a path, a range, a log or an option cannot be used.
        RunError: If the twin fails with the scenario's own values.
        StoppedError: If the search was stopped before it was done.
    """
    _check(scenario, fitted, start or {}, method)
    with ExitStack() as opened:
        own = [SimulatedLog(scenario, log, longest_delay) for log in _read(scenario, logs, renamed or {}, left_out)]
        for log in own:
            opened.callback(log.close)
        for end in ("low", "high"):
            own[0].start_at({item.path: getattr(item, end) for item in fitted})  # raises if it is not physical
        comparison = _comparison(own, noise or {}, longest_delay)
        before = [log.run({}) for log in own]
        evaluations = Evaluations(fitted, own, comparison, most_episodes, stopped, tell=tell)
        evaluations.episodes = len(own)
        try:
            found = _searched(evaluations, method, _start({**scenario.values, **(start or {})}, fitted))
            compared = comparison.compare(before)
            held_out = _held_out(evaluations, found, compared.residuals)
            after = evaluations.simulate(found.best.point)
        except Stopped:
            raise StoppedError(evaluations) from None
        curves = [
            Curve(topic, name, comparison.sigma(index), measured, old[1], new[1])
            for index, ((topic, name, measured, old), (*_, new)) in enumerate(
                zip(
                    comparison.curves(before, compared.delays), comparison.curves(after, found.best.delays), strict=True
                )
            )
        ]
        delay_errors = np.hypot(comparison.delay_errors(after, found.best.delays), found.delay_errors)
        delays = zip(comparison.topics, found.best.delays.tolist(), delay_errors.tolist(), strict=True)
        best, paths = found.best, [item.path for item in fitted]
        errors = {
            item.path: item.error(float(share), float(error))
            for item, share, error, is_unknown in zip(fitted, best.point, found.errors, found.unknown, strict=True)
            if not is_unknown
        }
        values = {path: value for path, value in evaluations.values(best.point).items() if path in errors}
        ends = [
            f"{item.path} is at the end of its range: the value may be outside"
            for item, share in zip(fitted, best.point, strict=True)
            if item.path in values and not 1e-3 < share < 1 - 1e-3
        ]
        chi_squared = best.cost / evaluations.freedom
        return Result(
            fitted=tuple(fitted),
            values=values,
            errors=errors,
            unknown=tuple(path for path in paths if path not in values),
            directions=tuple(tuple(paths[index] for index in direction) for direction in found.directions),
            correlation=found.correlation,
            chi_squared=chi_squared,
            chi_squared_before=float(compared.residuals @ compared.residuals) / evaluations.freedom,
            held_out=held_out,
            delays=tuple(delays) if longest_delay else (),
            minima=tuple(evaluations.values(item.point) for item in found.others),
            episodes=evaluations.episodes,
            problems=_problems(chi_squared, found, values),
            notes=(*ends, *dict.fromkeys(note for log in own for note in log.log.notes)),
            curves=tuple(curves),
            scenario=with_values(scenario, values),
        )


class StoppedError(RunError):
    """Raised when a calibration is stopped.

    Attributes:
        best: Path → the best value so far; empty without any.
    """

    def __init__(self, evaluations: Evaluations):
        self.best = evaluations.values(evaluations.best.point) if evaluations.every else {}
        super().__init__(f"stopped after {evaluations.episodes} episodes, so that nothing is known for certain")


def _searched(evaluations: Evaluations, method: str, start: np.ndarray | None) -> Certainty:
    """Search, and leave enough episodes for the certainty of what is found.

    Raises:
        InputError: If there are too few episodes.
        Stopped: If the search has to end.
    """
    most, size = evaluations.most, len(evaluations.fitted)
    starts = max(map(len, evaluations.comparison.start_errors()))
    kept = evaluations.simulations * (points_of(size) + 3 + starts)
    least = evaluations.episodes + kept + evaluations.simulations * 2 * size
    if most < least:
        raise InputError(f"{most} episodes are too few to fit {size} values: it takes {least} or more")
    evaluations.most = most - kept
    ends = search(evaluations, method, start)
    evaluations.most = most
    evaluations.settle_noise(evaluations.best.point)
    evaluations.settle_starts(evaluations.best.point)
    ends = [evaluations.at(end.point) for end in ends]
    return certainty(evaluations, ends)


def _check(scenario: Scenario, fitted: Sequence[Fitted], start: Mapping[str, float], method: str) -> None:
    if method not in METHODS:
        raise InputError(f"unknown method {method!r}", value=method, valid=METHODS)
    if not fitted:
        raise InputError("nothing to fit: --fit PATH=LOW:HIGH names a value and where to search it")
    if scenario.nodes:
        raise InputError("the scenario has node programs, which a calibration does not run: leave them out of it")
    paths = [item.path for item in fitted]
    for path in start:
        if path not in paths:
            raise InputError(f"--start {path}: this value is not fitted", value=path, valid=paths)
    for index, item in enumerate(fitted):
        if not item.low <= start.get(item.path, item.low) <= item.high:
            raise InputError(f"--start {item.path}={start[item.path]:g}: it is not from {item.low:g} to {item.high:g}")
        if item.path in paths[:index]:
            raise InputError(f"--fit {item.path} is given twice")
        for value in (item.low, item.high):
            with_values(scenario, {item.path: value})


def _read(
    scenario: Scenario, logs: Sequence[str | Path | Recording], renamed: Mapping[str, str], left_out: Sequence[str]
) -> list[Log]:
    from drake_twin.calibration.recorded_log import recorded_log

    if not logs:
        raise InputError("no log is given: --log names one")
    with Twin(scenario) as twin:
        endpoints = twin.graph.endpoints
    found = []
    for log in logs:
        if isinstance(log, Recording):
            found.append(recorded_log(log, endpoints))
        elif Path(log).suffix == ".json":
            found.append(recorded_log(Recording.load(log), endpoints, str(log)))
        else:
            found.append(read_bag(Path(log), endpoints, renamed))
    return [without(log, left_out) for log in found]


def _comparison(logs: Sequence[SimulatedLog], noise: Mapping[str, float], longest_delay: float) -> Comparison:
    names = {name for log in logs for item in log.log.measured for name in item.series}
    check_names(noise, names)
    return Comparison([log.log for log in logs], noise, [log.samples_of_start for log in logs], longest_delay)


def _start(known: Mapping[str, float], fitted: Sequence[Fitted]) -> np.ndarray | None:
    """Return known values as shares of the ranges, the middle for others; None without any."""
    shares = [item.share(known[item.path]) if item.path in known else 0.5 for item in fitted]
    return np.array(shares) if any(item.path in known for item in fitted) else None


def _held_out(evaluations: Evaluations, found: Certainty, before: np.ndarray) -> tuple[float, float]:
    """Return χ² over the number of measurements of the second halves, before and after a fit to the first ones.

    That fit is the best point moved by the derivatives there, to where it is best for the first halves.
    """
    late = evaluations.comparison.is_late
    slopes, residuals = found.slopes[~late], found.best.residuals[~late]
    normal = slopes.T @ slopes + 12 * np.eye(slopes.shape[1])
    early = evaluations.at(found.best.point - np.linalg.solve(normal, slopes.T @ residuals))
    own = min((early, found.best), key=lambda item: float(np.sum(item.residuals[~late] ** 2)))
    if not late.any():
        return float("nan"), float("nan")
    return float(np.mean(before[late] ** 2)), float(np.mean(own.residuals[late] ** 2))


def _problems(chi_squared: float, found: Certainty, values: Mapping[str, float]) -> tuple[str, ...]:
    problems = []
    if chi_squared > FITS:
        problems.append(
            f"χ²/dof is {chi_squared:.3g}, above {FITS:g}: with no values of these ranges the twin moves as measured"
        )
    if found.others:
        problems.append(f"{len(found.others) + 1} places of the ranges fit equally well")
    if not values:
        problems.append("the logs tell none of the values")
    return tuple(problems)
