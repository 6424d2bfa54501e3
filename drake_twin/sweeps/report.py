"""What a table says: outcomes, best and worst rows, which values matter; and figures of it."""

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from drake_twin.errors import InputError
from drake_twin.requirements import missing
from drake_twin.sweeps.episode import COLUMNS, ERROR, Row
from drake_twin.values import is_number
from drake_twin.whole_file import write_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SHOWN = 3  # rows, best and worst
_MOST_BINS = 12


def metric_names(definition: Mapping[str, Any], rows: Sequence[Row]) -> list[str]:
    """Return the columns of the metrics."""
    varied = {path for path, _ in definition["vary"]}
    return [name for name in dict.fromkeys(key for row in rows for key in row) if name not in {*COLUMNS, *varied}]


def sensitivities(definition: Mapping[str, Any], rows: Sequence[Row]) -> dict[tuple[str, str], float]:
    """Return the rank correlation (Spearman's) of each value with each metric, where both vary."""
    from scipy.stats import spearmanr

    found = {}
    for metric in metric_names(definition, rows):
        for path, _ in definition["vary"]:
            pairs = [
                (row[path], row[metric]) for row in rows if is_number(row.get(path)) and is_number(row.get(metric))
            ]
            xs, ys = np.array(pairs, dtype=float).reshape(-1, 2).T
            if len(pairs) > 2 and np.ptp(xs) > 0 and np.ptp(ys) > 0:
                found[path, metric] = float(spearmanr(xs, ys).statistic)
    return found


def report(definition: Mapping[str, Any], rows: Sequence[Row]) -> str:
    """Return a table as text: how many rows came out how, each metric's spread, best and worst rows, sensitivities."""
    outcomes = Counter(row["outcome"] for row in rows)
    lines = [f"{len(rows)} rows: " + ", ".join(f"{count} {what}" for what, count in outcomes.most_common())]
    paths = [path for path, _ in definition["vary"]]
    metrics = metric_names(definition, rows)
    for name in metrics:
        values = sorted((row[name], row["episode"]) for row in rows if is_number(row.get(name)))
        if not values:
            continue
        numbers = [value for value, _ in values]
        median = float(np.median(numbers))
        lines.append(f"{name}: least {numbers[0]:.6g}, median {median:.6g}, largest {numbers[-1]:.6g}")
        by_number = {row["episode"]: row for row in rows}
        for what, shown in (("least", values[:_SHOWN]), ("largest", values[: -_SHOWN - 1 : -1])):
            for value, number in shown:
                lines.append(f"  {what:7} {value:<12.6g} row {number}: {_values(by_number[number], paths)}")
    table = sensitivities(definition, rows)
    if table:
        lines.append("rank correlation of value and metric (1: rises with it, -1: falls with it)")
        width = max(len(path) for path, _ in table)
        for name in metrics:
            own = sorted(
                ((rho, path) for (path, metric), rho in table.items() if metric == name), key=lambda x: -abs(x[0])
            )
            lines += [f"  {name}  {path:{width}}  {rho:+.2f}" for rho, path in own]
    errors = Counter(row["reason"] for row in rows if row["outcome"] == ERROR)
    lines += [f"error in {count} rows: {reason}" for reason, count in errors.most_common(_SHOWN)]
    return "\n".join(lines)


def draw(file: Path, definition: Mapping[str, Any], rows: Sequence[Row]) -> None:
    """Draw each metric over each value: all rows, the median, and the quarter to three quarters of them.

    Raises:
        InputError: If Matplotlib is missing, or there is nothing to draw.
        RunError: If the file cannot be written.
    """
    figure_type, metrics, paths = _drawn("--plot", definition, rows, least=1)
    figure = figure_type(figsize=(4.0 * len(paths) + 1, 3.0 * len(metrics) + 0.5), layout="constrained")
    axes = figure.subplots(len(metrics), len(paths), squeeze=False)
    for line, metric in zip(axes, metrics, strict=True):
        for axis, path in zip(line, paths, strict=True):
            pairs = np.array([(row[path], row[metric]) for row in rows if is_number(row.get(metric))], dtype=float)
            _draw_one(axis, pairs.reshape(-1, 2))
            axis.set_xlabel(path)
            axis.set_ylabel(metric)
    write_figure("figure", file, figure)


def draw_pairs(file: Path, definition: Mapping[str, Any], rows: Sequence[Row]) -> None:
    """Draw each two values against each other, a line of axes for each metric, which colors the rows.

    Raises:
        InputError: If Matplotlib is missing, or there are less than two varied numbers, or no metric.
        RunError: If the file cannot be written.
    """
    figure_type, metrics, paths = _drawn("--pairs", definition, rows, least=2)
    pairs = list(combinations(paths, 2))
    figure = figure_type(figsize=(4.0 * len(pairs) + 1, 3.0 * len(metrics) + 0.5), layout="constrained")
    axes = figure.subplots(len(metrics), len(pairs), squeeze=False)
    for line, metric in zip(axes, metrics, strict=True):
        shown = [row for row in rows if is_number(row.get(metric))]
        for axis, (across, up) in zip(line, pairs, strict=True):
            xs, ys, colors = ([row[name] for row in shown] for name in (across, up, metric))
            points = axis.scatter(xs, ys, c=colors, s=20)
            axis.set_xlabel(across)
            axis.set_ylabel(up)
        figure.colorbar(points, ax=list(line), label=metric)
    write_figure("figure", file, figure)


def _drawn(
    option: str, definition: Mapping[str, Any], rows: Sequence[Row], *, least: int
) -> tuple["type[Figure]", list[str], list[str]]:
    """Return Matplotlib's figure, and the metrics and the values that can be drawn.

    Raises:
        InputError: If Matplotlib is missing, without a metric, or with fewer values than the least number.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise missing(f"{option} needs", "matplotlib") from None
    metrics = metric_names(definition, rows)
    paths = [path for path, _ in definition["vary"] if all(is_number(row.get(path)) for row in rows)]
    if not metrics or len(paths) < least:
        what = "no varied number" if least == 1 else "less than two varied numbers"
        raise InputError(f"{option}: the table has no metric, or {what}, to draw")
    return Figure, metrics, paths


def _draw_one(axis: Any, pairs: np.ndarray) -> None:
    axis.plot(pairs[:, 0], pairs[:, 1], ".", color="0.7", markersize=3)
    xs = np.unique(pairs[:, 0])
    groups = [pairs[pairs[:, 0] == x] for x in xs]
    if len(xs) > _MOST_BINS:
        edges = np.quantile(pairs[:, 0], np.linspace(0, 1, _MOST_BINS + 1))
        places = np.clip(np.searchsorted(edges, pairs[:, 0], side="right") - 1, 0, _MOST_BINS - 1)
        groups = [pairs[places == index] for index in range(_MOST_BINS) if (places == index).any()]
    if groups:
        middles = [float(np.median(group[:, 0])) for group in groups]
        low, median, high = np.array([np.quantile(group[:, 1], (0.25, 0.5, 0.75)) for group in groups]).T
        axis.fill_between(middles, low, high, alpha=0.25)
        axis.plot(middles, median, "o-")


def _values(row: Row, paths: Sequence[str]) -> str:
    shown = [f"{path}={row[path]:.6g}" if is_number(row[path]) else f"{path}={row[path]}" for path in paths]
    return ", ".join([*shown, f"seed {row['seed']}"])
