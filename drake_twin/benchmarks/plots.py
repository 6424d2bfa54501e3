"""The results as figures: real-time factor over the number of robots, and over the error."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from drake_twin.benchmarks.report import Cell, Table
from drake_twin.whole_file import write_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LINES = ("twin, cenic", "twin, similar", "twin, sap", "twin", "DART", "MuJoCo")  # of work against precision


def draw(tables: Sequence[Table], folder: Path) -> list[Path]:
    """Draw the tables that have a figure.

    Args:
        tables: The results.
        folder: The folder to write to.

    Returns:
        The written files.
    """
    files = []
    robots = [table for table in tables if table.section == "robots"]
    if robots:
        files.append(_draw_robots(robots, folder / "robots.svg"))
    precision = [table for table in tables if table.title.startswith("Work and precision")]
    if precision:
        files.append(_draw_precision(precision, folder / "precision.svg"))
    return files


def _draw_robots(tables: Sequence[Table], file: Path) -> Path:
    figure, panels = _panels(len(tables))
    for panel, table in zip(panels, tables, strict=False):
        for index, name in enumerate(table.columns[1:], start=1):
            _line(panel, name, [(row[0], row[index]) for row in table.rows])
        panel.axhline(1.0, color="0.6", lw=0.8)
        _label(panel, table.title.partition(": ")[2], "robots", "real-time factor")
    panels[0].legend(fontsize=7)
    return _save(figure, file)


def _draw_precision(tables: Sequence[Table], file: Path) -> Path:
    figure, panels = _panels(len(tables))
    for panel, table in zip(panels, tables, strict=False):
        engines: dict[str, list[tuple[float, float]]] = {}
        for setting, error, factor in table.rows:
            name = next(known for known in _LINES if str(setting).startswith(known))
            engines.setdefault(name, []).append((float(str(error)), float(str(factor))))
        for name, points in engines.items():
            _line(panel, name, points)
        _label(panel, table.title.partition(": ")[2], "error (rad)", "real-time factor")
    panels[0].legend(fontsize=7)
    return _save(figure, file)


def _panels(count: int) -> "tuple[Figure, list[Axes]]":
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams["svg.fonttype"] = "none"  # text as text: a fifth of the size
    from matplotlib import pyplot

    columns = min(3, count)
    rows = -(-count // columns)
    figure, axes = pyplot.subplots(rows, columns, figsize=(4.6 * columns, 3.6 * rows), squeeze=False)
    panels = list(axes.flat)
    for panel in panels[count:]:
        panel.set_visible(False)
    return figure, panels


def _line(panel: "Axes", name: str, points: Sequence[tuple[Cell, Cell]]) -> None:
    panel.loglog(*zip(*points, strict=True), "o-", label=name, ms=3)


def _label(panel: "Axes", title: str, x: str, y: str) -> None:
    panel.set_title(title, fontsize=8)
    panel.set_xlabel(x, fontsize=8)
    panel.set_ylabel(y, fontsize=8)
    panel.grid(visible=True, lw=0.3)


def _save(figure: "Figure", file: Path) -> Path:
    figure.tight_layout()
    write_figure("figure", file, figure)
    return file
