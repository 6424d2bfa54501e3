"""What a calibration says: as text, as a figure, and as the fitted scenario."""

from pathlib import Path

import numpy as np

from drake_twin.calibration.measured import UNITS, kind_of
from drake_twin.calibration.result import Curve, Result
from drake_twin.requirements import missing
from drake_twin.scenario.scenario_file import scenario_to_yaml
from drake_twin.versions import stamp
from drake_twin.whole_file import write_figure, write_result

_UNKNOWN = 10.0  # s; the error of a delay of which a log says nothing


def report(result: Result) -> str:
    """Return what was found, as text."""
    before = f"{result.chi_squared_before:.4g} with the scenario's own values"
    lines = [f"{result.episodes} episodes, χ²/dof {result.chi_squared:.3f} ({before})"]
    width = max(len(item.path) for item in result.fitted)
    for item in result.fitted:
        if item.path in result.values:
            value, error = result.values[item.path], result.errors[item.path]
            lines.append(f"  {item.path:{width}}  {value:.5g} ± {error:.2g}  (searched {item.low:g} to {item.high:g})")
        else:
            lines.append(f"  {item.path:{width}}  not known from these logs: the scenario's own value stays")
    mixed = [direction for direction in result.directions if len(direction) > 1]
    lines += [f"the logs do not tell apart: {', '.join(direction)}" for direction in mixed]
    if len(result.fitted) > 1:
        lines += ["correlations", *_correlations(result, width)]
    for topic, delay, error in result.delays:
        if error > _UNKNOWN:
            lines.append(f"how late {topic} is cannot be known from these logs: nothing in it changes")
            continue
        lines.append(f"{topic} is {1e3 * delay:.2f} ± {1e3 * error:.2g} ms late (its clock and all delays together)")
    own, other = result.held_out
    lines.append(
        f"second halves of the logs: χ² per measurement {own:.4g} with the scenario's own values,"
        f" {other:.4g} with those of a fit to the first halves"
    )
    lines += ["root mean square error, before and after", *_errors(result)]
    lines += [f"as good: {_values(minimum)}" for minimum in result.minima]
    lines += [f"note: {note}" for note in result.notes]
    lines += [f"problem: {problem}" for problem in result.problems]
    return "\n".join(lines)


def _correlations(result: Result, width: int) -> list[str]:
    lines = []
    for index, item in enumerate(result.fitted):
        numbers = " ".join(f"{number:+.2f}" for number in result.correlation[index])
        lines.append(f"  {item.path:{width}}  {numbers}")
    return lines


def _values(values: dict[str, float] | object) -> str:
    assert isinstance(values, dict)
    return ", ".join(f"{path}={value:.5g}" for path, value in values.items())


def root_mean_squares(result: Result) -> dict[tuple[str, str], tuple[float, float]]:
    """Return topic and kind → root mean square error, before and after (in the unit of the kind)."""
    groups: dict[tuple[str, str], list[Curve]] = {}
    for curve in result.curves:
        groups.setdefault((curve.topic, kind_of(curve.name)), []).append(curve)
    return {key: (_rms(own, "before"), _rms(own, "after")) for key, own in groups.items()}


def _rms(curves: list[Curve], which: str) -> float:
    errors = np.concatenate([curve.measured[1] - getattr(curve, which) for curve in curves])
    return float(np.sqrt(np.mean(errors**2)))


def _errors(result: Result) -> list[str]:
    return [
        f"  {topic} {kind}: {before:.3g} → {after:.3g} {UNITS[kind]}"
        for (topic, kind), (before, after) in root_mean_squares(result).items()
    ]


def draw(file: Path, result: Result) -> None:
    """Draw each number, measured and simulated, over time.

    Raises:
        InputError: If Matplotlib is missing.
        RunError: If the file cannot be written.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise missing("--plot needs", "matplotlib") from None
    rows = max(1, len(result.curves))
    columns = 1 if rows <= 4 else 3
    figure = Figure(figsize=(5.0 * columns + 1, 2.2 * -(-rows // columns) + 0.6), layout="constrained")
    axes = figure.subplots(-(-rows // columns), columns, squeeze=False).ravel()
    for axis, curve in zip(axes, result.curves, strict=False):
        times, values = curve.measured
        axis.plot(times, values, ".", color="0.6", markersize=3, label="measured")
        axis.plot(times, curve.before, "--", linewidth=0.8, label="before")
        axis.plot(times, curve.after, linewidth=1.0, label="fitted")
        axis.set_title(f"{curve.topic} {curve.name}", fontsize="small")
        axis.set_ylabel(UNITS[kind_of(curve.name)])
    for axis in axes[len(result.curves) :]:
        axis.set_visible(False)
    axes[0].legend(fontsize="small")
    for axis in axes[max(0, len(result.curves) - columns) : len(result.curves)]:
        axis.set_xlabel("time of the log (s)")
    write_figure("figure", file, figure)


def write_fitted(file: Path, result: Result) -> None:
    """Write the scenario with the fitted values, and what they are as its first lines.

    Raises:
        RunError: If the file cannot be written.
    """
    known = [f"# {path}: {value:.5g} ± {result.errors[path]:.2g}" for path, value in result.values.items()]
    known += [f"# {path}: not known from the logs" for path in result.unknown]
    known += [f"# problem: {problem}" for problem in result.problems]
    head = [f"# Fitted by drake_twin.calibrate: χ²/dof {result.chi_squared:.3f}; {stamp()}", *known]
    write_result("scenario", file, "\n".join([*head, scenario_to_yaml(result.scenario)]))
