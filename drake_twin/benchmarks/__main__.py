"""``python -m drake_twin.benchmarks``: measures, prints and saves the results."""

import sys
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

from drake_twin.benchmarks.plots import draw
from drake_twin.benchmarks.report import Table, save
from drake_twin.benchmarks.sections import SECTIONS
from drake_twin.benchmarks.size import Size
from drake_twin.errors import InputError
from drake_twin.program import ArgumentParser, add_version, run_program, say
from drake_twin.requirements import EXTRAS, missing
from drake_twin.scratch_folder import scratch_folder


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program; return its exit code."""
    return run_program(_main, arguments)


def _parser() -> ArgumentParser:
    parser = ArgumentParser(prog="drake_twin.benchmarks", description=__doc__)
    parser.add_argument("sections", nargs="*", metavar="SECTION", help=f"what to measure: {', '.join(SECTIONS)}")
    parser.add_argument("--output", type=Path, default=Path("benchmarks"), help="the folder for results")
    parser.add_argument("--repeats", type=int, default=5, help="how often to run each case")
    parser.add_argument("--robots", help="numbers of robots, such as 1,8,32 (default: up to 32 or 64)")
    parser.add_argument("--quick", action="store_true", help="tiny sizes, to check that everything runs")
    parser.add_argument("--debug", action="store_true", help="show tracebacks")
    add_version(parser)
    return parser


def _main(arguments: Sequence[str]) -> int:
    options = _parser().parse_args(list(arguments))
    for section in options.sections:
        if section not in SECTIONS:
            raise InputError(f"unknown section {section!r}", value=section, valid=SECTIONS)
    counts = None if options.robots is None else _numbers(options.robots)
    absent = [name for name in EXTRAS["benchmarks"].modules if find_spec(name) is None]
    if "dartpy" in absent:
        absent.remove("dartpy")
        say("DART is left out: dartpy is not installed, and has wheels for Linux only", sys.stderr)
    if "pybullet" in absent and sys.version_info >= (3, 12):
        absent.remove("pybullet")
        say("PyBullet is left out: it is not installed, and has no wheel for Python 3.12 and later", sys.stderr)
    if absent:
        raise missing("the benchmarks need", *absent)
    tables: list[Table] = []
    with tempfile.TemporaryDirectory(dir=scratch_folder()) as folder:
        size = Size(Path(folder), max(1, options.repeats))
        if options.quick:
            size = Size(Path(folder), repeats=1, counts=(1, 2), many=(1, 2), scale=0.05)
        if counts is not None:
            size = replace(size, counts=counts, many=counts)
        for name in options.sections or SECTIONS:
            say(f"measuring: {name} …", sys.stderr)
            for table in SECTIONS[name](size):
                tables.append(table)
                say(table.markdown())
            save(tables, options.output)  # after each section, so that no result is lost
    for file in (options.output / "benchmarks.json", options.output / "benchmarks.md", *draw(tables, options.output)):
        say(f"wrote {file}")
    return 0


def _numbers(text: str) -> tuple[int, ...]:
    try:
        numbers = tuple(sorted({int(item) for item in text.split(",")}))
    except ValueError:
        numbers = ()
    if not numbers or numbers[0] < 1:
        raise InputError(f"--robots {text!r}: expected numbers from 1 on, such as 1,8,32", value=text)
    return numbers


if __name__ == "__main__":
    sys.exit(main())
