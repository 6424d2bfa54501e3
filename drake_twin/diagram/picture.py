"""The picture of a diagram: DOT text that is the same in every run, and SVG that contains its DOT text."""

import re
import shutil
import subprocess
from collections.abc import Iterator
from itertools import groupby, zip_longest
from pathlib import Path

from pydrake.systems.framework import Diagram

from drake_twin.errors import InputError, RunError
from drake_twin.whole_file import write_result

_IDENTIFIER = re.compile(r'(?<![\w">])(_|s|clusters?)(\d+)')
_SYSTEM = re.compile(
    r"^(s\d+(?:in|out)?)( \[.*\n<TABLE .*\n<TR><TD .*\n.*\n.*\n</TD></TR>\n)((?:.*\n)*?)</TABLE>", re.MULTILINE
)
_PORT = re.compile(r'<TD PORT="([uy])(\d+)"[^>]*>(.+)</TD>')
_END = re.compile(r"\b(s\d+(?:in|out)?):([uy])(\d+):(?=[we]\b)")
_NOTHING = '<TD BORDER="1" COLOR="grey"{} SIDES="BLR"></TD>'


def dot_text(diagram: Diagram) -> str:
    """Return the diagram and its robots' sub-diagrams as Graphviz DOT, without anything that differs between runs.

    Only connected ports are drawn: Drake's plant has many more, and they differ between its versions.
    """
    text = diagram.GetGraphvizString(max_depth=2, options={"plant/split": "I/O"})
    numbers: dict[str, str] = {}  # Drake numbers systems by the number created before in the process
    text = _IDENTIFIER.sub(lambda match: match[1] + numbers.setdefault(match[2], str(len(numbers))), text)
    return "\n".join(_with_sorted_edges(_with_connected_ports(text).splitlines())) + "\n"


def _with_connected_ports(text: str) -> str:
    """Draw only ports with an edge, numbered in their order."""
    connected = {end.groups() for end in _END.finditer(text)}
    numbers: dict[tuple[str, ...], int] = {}

    def draw(match: re.Match[str]) -> str:
        system, head, body = match.groups()
        sides = {}
        for side in "uy":
            ports = [
                item for item in _PORT.finditer(body) if item[1] == side and (system, *item.groups()[:2]) in connected
            ]
            numbers.update({(system, side, port[2]): index for index, port in enumerate(ports)})
            sides[side] = [
                f'<TD PORT="{side}{index}" BORDER="1"{{}}>{port[3]}</TD>' for index, port in enumerate(ports)
            ]
        return f"{system}{head}{_rows(sides['u'], sides['y'])}</TABLE>"

    text = _SYSTEM.sub(draw, text)
    return _END.sub(lambda end: f"{end[1]}:{end[2]}{numbers[end[1], end[2], end[3]]}:", text)


def _rows(left: list[str], right: list[str]) -> str:
    """Return the rows of a table of two columns, the last cell of the shorter one as high as the rows that it lacks."""
    columns = [column or [_NOTHING] for column in (left, right)]
    count = max(map(len, columns))
    for column in columns:
        span = count + 1 - len(column)
        column[-1] = column[-1].format(f' ROWSPAN="{span}"' if span > 1 else "")
    rows = zip_longest(*([*(cell.format("") for cell in column[:-1]), column[-1]] for column in columns))
    return "".join("\n".join(("<TR>", *filter(None, row), "</TR>\n")) for row in rows)


def write_picture(diagram: Diagram, file: Path) -> None:
    """Write a diagram's picture.

    Args:
        diagram: The diagram.
        file: A ``.dot`` file, or an ``.svg`` file, for which Graphviz's ``dot`` program must be installed.

    Raises:
        InputError: If the suffix is another one, or ``dot`` is not installed.
        RunError: If ``dot`` fails, or the file cannot be written.
    """
    text = dot_text(diagram)
    if file.suffix == ".svg":
        try:
            text = svg_of(text)
        except InputError as error:
            without = f"{file.with_suffix('.dot').name} can be written without it"
            raise InputError(f"{error.message}; {without}", file=file) from None
    elif file.suffix != ".dot":
        raise InputError(f"a diagram is written as .dot or .svg, not {file.suffix!r}", file=file)
    write_result("picture", file, text)


def _with_sorted_edges(lines: list[str]) -> Iterator[str]:
    """Sort the runs of edges: Drake lists a system's edges in the order of a hash table."""
    for is_edge, run in groupby(lines, key=lambda line: " -> " in line):
        run_of_lines = list(run)
        yield from sorted(run_of_lines) if is_edge else run_of_lines


def svg_of(text: str) -> str:
    """Return DOT text as SVG, which contains the text.

    Raises:
        InputError: If Graphviz's ``dot`` program is not installed.
        RunError: If it fails.
    """
    program = shutil.which("dot")
    if program is None:
        raise InputError(
            "an SVG needs Graphviz's program 'dot', which is not installed (on Debian and Ubuntu: apt install graphviz)"
        )
    drawn = subprocess.run([program, "-Tsvg"], input=text, capture_output=True, text=True, check=False)
    if drawn.returncode != 0:
        raise RunError(f"dot failed: {drawn.stderr.strip()}")
    return drawn.stdout.replace("</svg>", f"<metadata><![CDATA[{text}]]></metadata>\n</svg>")
