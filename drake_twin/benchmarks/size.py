"""How much the benchmarks measure."""

from pathlib import Path

from drake_twin.dataclass import dataclass


@dataclass(frozen=True)
class Size:
    """The size of the measurements.

    Attributes:
        folder: A folder for files that engines read.
        repeats: How often each case runs.
        counts: Numbers of robots.
        many: Numbers of robots in the sections that vary the number.
        scale: A factor on the simulated times.
    """

    folder: Path
    repeats: int = 5
    counts: tuple[int, ...] = (1, 8, 32)
    many: tuple[int, ...] = (1, 4, 8, 16, 32, 64)
    scale: float = 1.0
