"""Results as tables in Markdown and JSON."""

import json
import platform
from collections.abc import Sequence
from dataclasses import asdict
from datetime import date
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from drake_twin.dataclass import dataclass
from drake_twin.whole_file import write_result

Cell = str | float | int | None


@dataclass(frozen=True)
class Table:
    """One table of results.

    Attributes:
        section: The section of the benchmarks.
        title: The title.
        columns: The names of the columns.
        rows: The cells; None where nothing was measured.
    """

    section: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def markdown(self) -> str:
        """Return the table in Markdown."""
        lines = [self.columns, ["---"] * len(self.columns), *([_text(cell) for cell in row] for row in self.rows)]
        return f"### {self.title}\n\n" + "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def machine() -> dict[str, str]:
    """Return the date, the machine and the versions of a measurement."""
    processor = platform.processor() or platform.machine()
    file = Path("/proc/cpuinfo")
    if file.exists():
        names = [line.partition(":")[2].strip() for line in file.read_text().splitlines() if "model name" in line]
        processor = f"{len(names)} x {names[0]}" if names else processor
    packages = ["drake", "mujoco", "numpy", *(name for name in ("dartpy", "pybullet") if find_spec(name))]
    return {
        "date": date.today().isoformat(),
        "processor": processor,
        "system": platform.platform(),
        "Python": platform.python_version(),
    } | {name: version(name) for name in packages}


def save(tables: Sequence[Table], folder: Path) -> None:
    """Write ``benchmarks.json`` and ``benchmarks.md`` to a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    what = {"machine": machine(), "tables": [asdict(table) for table in tables]}
    write_result("report", folder / "benchmarks.json", json.dumps(what, indent=1) + "\n")
    measured_on = ", ".join(f"{name} {value}" for name, value in machine().items())
    text = "\n".join([f"Measured on: {measured_on}.\n", *(table.markdown() for table in tables)])
    write_result("report", folder / "benchmarks.md", text)


def _text(cell: Cell) -> str:
    if cell is None:
        return "–"
    return (
        f"{cell:.3g}"
        if isinstance(cell, float) and abs(cell) < 100
        else f"{cell:.0f}"
        if isinstance(cell, float)
        else str(cell)
    )
