"""A run as a figure: positions, velocities and efforts of each robot's joints, and the real-time factor.

The figure has one column per robot, up to six side by side. Of a robot with many joints, the ones that move most are
named and colored, the others gray.
"""

from __future__ import annotations

from importlib.util import find_spec
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_twin.errors import InputError
from drake_twin.requirements import missing
from drake_twin.whole_file import write_figure

if TYPE_CHECKING:  # the history needs Drake; checking a name does not
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from drake_twin.cli.history import RobotHistory, RunHistory

SUFFIXES = (".png", ".svg", ".pdf")

_MOST_COLUMNS = 6
_MOST_NAMED = 10  # joints of a robot: the number of distinguishable colors
_COLUMN_WIDTHS = {1: 7.0, 2: 4.6}  # inch; three and more are narrower
_NARROW = 3.4
_ROW, _GAP = 1.35, 0.12  # inch: the height of an axis, and the gap between two of a robot
_LEFT, _RIGHT, _TOP, _BOTTOM = 0.75, 0.2, 0.45, 0.5  # inch, around a column and around the figure
_TITLE, _LEGEND_LINE = 0.3, 0.16  # inch
_DOTS_PER_INCH, _MOST_DOTS = 120.0, 32_000.0
_GREY = "0.75"
_SMALLEST_SPAN = 1e-5  # of an axis, in its unit


def check_plot_file(file: Path) -> None:
    """Check before the run that a plot can be drawn.

    Raises:
        InputError: If the file's suffix is not ``.png``, ``.svg`` or ``.pdf``, or Matplotlib is not installed.
    """
    if file.suffix.lower() not in SUFFIXES:
        raise InputError(
            f"--plot {file}: the name must end in one of the formats of a plot", value=file.suffix, valid=SUFFIXES
        )
    if find_spec("matplotlib") is None:
        raise missing(f"--plot {file} needs", "matplotlib")


def write_plot(history: RunHistory, file: Path) -> None:
    """Draw a run.

    Args:
        history: The run.
        file: The file to write: ``.png``, ``.svg`` or ``.pdf``.

    Raises:
        RunError: If the file cannot be written.
    """
    from matplotlib import rc_context
    from matplotlib.figure import Figure  # without pyplot, which would need a display

    robots = {name: robot for name, robot in history.robots.items() if robot.joints}
    columns = max(1, min(len(robots), _MOST_COLUMNS))
    column = _COLUMN_WIDTHS.get(columns, _NARROW)
    names = list(robots)
    bands = [names[first : first + columns] for first in range(0, len(names), columns)]
    heights = [_band_height([robots[name] for name in band]) for band in bands]
    width = columns * (_LEFT + column + _RIGHT)
    height = _TOP + sum(heights) + _TITLE + _ROW + _BOTTOM
    with rc_context({"font.size": 8, "svg.fonttype": "none", "axes.spines.top": False, "axes.spines.right": False}):
        sheet = _Sheet(Figure(figsize=(width, height)), width, height)
        y = height - _TOP
        for band, band_height in zip(bands, heights, strict=True):
            for index, name in enumerate(band):
                _draw_robot(
                    sheet, index * (_LEFT + column + _RIGHT) + _LEFT, y, column, name, robots[name], band_height
                )
            y -= band_height
        axes = sheet.axes(_LEFT, y - _TITLE - _ROW, width - _LEFT - _RIGHT, _ROW)
        _draw_real_time_factor(axes, history)
        dots = min(_DOTS_PER_INCH, _MOST_DOTS / max(width, height))
        write_figure("plot", file, sheet.figure, dpi=dots)


class _Sheet:
    """A figure whose axes are placed in inches from the lower left corner."""

    def __init__(self, figure: Figure, width: float, height: float):
        self.figure = figure
        self._width, self._height = width, height

    def axes(self, x: float, y: float, width: float, height: float, **more: Any) -> Axes:
        box = (x / self._width, y / self._height, width / self._width, height / self._height)
        axes = self.figure.add_axes(box, **more)
        axes.grid(color="0.92", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.margins(x=0)
        return axes


def _band_height(robots: list[RobotHistory]) -> float:
    lines = max(_legend_lines(robot) for robot in robots)
    return _TITLE + lines * _LEGEND_LINE + 3 * _ROW + 2 * _GAP + _BOTTOM


def _legend_lines(robot: RobotHistory) -> int:
    named, others = _named_joints(robot)
    return ceil((len(named) + bool(others)) / 2)


def _named_joints(robot: RobotHistory) -> tuple[list[int], list[int]]:
    """Return the indices of the joints with a color and a name, and of the others."""
    every = list(range(len(robot.joints)))
    if len(every) <= _MOST_NAMED or not len(robot.times):
        return every[:_MOST_NAMED], every[_MOST_NAMED:]
    import numpy as np

    busiest = np.argsort(-np.ptp(robot.positions, axis=0), kind="stable")[:_MOST_NAMED].tolist()
    return sorted(busiest), [joint for joint in every if joint not in busiest]


def _draw_robot(
    sheet: _Sheet, x: float, top: float, width: float, name: str, robot: RobotHistory, band_height: float
) -> None:
    """Draw three axes below each other, with one legend above them."""
    named, others = _named_joints(robot)
    units = list(dict.fromkeys(robot.units))
    forces = [{"rad": "N·m", "m": "N"}[unit] for unit in units]
    rows = (
        (robot.positions, f"position ({', '.join(units)})"),
        (robot.velocities, f"velocity ({', '.join(f'{unit}/s' for unit in units)})"),
        (robot.efforts, f"effort ({', '.join(forces)})"),
    )
    y = top - band_height + _BOTTOM + 2 * (_ROW + _GAP)
    first = None
    for values, label in rows:
        axes = sheet.axes(x, y, width, _ROW, sharex=first)
        for joint in others:
            axes.plot(robot.times, values[:, joint], color=_GREY, linewidth=0.5)
        for color, joint in enumerate(named):
            axes.plot(
                robot.times, values[:, joint], color=f"C{color}", linewidth=1.0, label=_short(robot.joints[joint], name)
            )
        axes.set_ylabel(label)
        _widen(axes)
        first = first or axes
        if y > top - band_height + _BOTTOM + _GAP:
            axes.tick_params(labelbottom=False)
        y -= _ROW + _GAP
    axes.set_xlabel("simulated time (s)")
    if first is not None:
        if others:
            first.plot([], [], color=_GREY, linewidth=0.5, label=f"{len(others)} more, which move less")
        first.legend(
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            ncols=2,
            frameon=False,
            fontsize=7,
            borderaxespad=0.2,
            labelspacing=0.25,
        )
        title_height = (_legend_lines(robot) * _LEGEND_LINE + 0.1) * 72
        first.annotate(
            name, (0, 1), (0, title_height), xycoords="axes fraction", textcoords="offset points", weight="bold", size=9
        )


def _draw_real_time_factor(axes: Axes, history: RunHistory) -> None:
    if len(history.real_time_factors):
        axes.stairs(history.real_time_factors, history.window_edges, baseline=None, color="C0")
    axes.set_ylim(0.0, 1.1 * max(history.real_time_factors, default=1.0))
    axes.set_ylabel("real-time factor")
    axes.set_xlabel("simulated time (s)")


def _widen(axes: Axes) -> None:
    """Show a constant as a line, instead of the noise of its last bits."""
    axes.ticklabel_format(useOffset=False)
    lower, upper = axes.get_ylim()
    if upper - lower < _SMALLEST_SPAN:
        middle = (lower + upper) / 2
        axes.set_ylim(middle - 0.1, middle + 0.1)


def _short(joint: str, robot: str) -> str:
    """Return a joint's name without the robot's name. Matplotlib would omit names that start with _."""
    return joint.removeprefix(f"{robot}_").removesuffix("_joint").lstrip("_") or joint
