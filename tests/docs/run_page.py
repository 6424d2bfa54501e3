"""``python run_page.py PAGE.md``: do what a page says, in the present folder, as a reader would from top to bottom.

- A block after a line that ends in a file's name and a colon (`` `arm.yaml`: ``) is saved under that name.
- Other Python blocks are one program.
- Commands of drake_twin's programs run, headless and for a moment. Where a word begins with ``path/to`` or an option
  waits for someone, only the options are parsed. Tests that the page has saved run with pytest.
- Other blocks of YAML and JSON are parsed.
"""

import contextlib
import io
import json
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import yaml

FILE_NAME = re.compile(r"`([\w./-]+\.\w+)`[^`]*:$")
WAITS = ("--watch", "--view", "--viewer", "--compare")
# Commands of other programs, and those that take too long.
OTHERS = (
    "pip",
    "python3",
    ".venv/bin/",
    ".ci/run",
    "git ",
    "ros2 ",
    "meshcat-server",
    "cd ",
    "ruff",
    "mypy",
    "jupyter",
    "ray start",
)
TOO_LONG = ("python -m pytest", "python -m drake_twin.benchmarks", "python -m drake_twin.controllers.docs")
MIRROR = "drake_twin.mirror"  # it takes the options of drake_twin.run, too
ELSEWHERE = ("python diagrams/", "python -m sphinx")  # run by tests/diagrams and tests/docs/test_build.py


@dataclass(frozen=True)
class Block:
    """A fenced block of a page: its language, its text, its first line's number, and the file it is saved as."""

    language: str
    text: str
    line: int
    file: str | None


def blocks(page: Path) -> Iterator[Block]:
    """The fenced blocks of a page in order."""
    before, fence, lines, start = "", "", [], 0
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        if fence:
            if line.strip() == "```":
                named = FILE_NAME.search(before)
                yield Block(fence, "\n".join(lines) + "\n", start, named[1] if named else None)
                before, fence = "", ""
            else:
                lines.append(line)
        elif line.startswith("```"):
            fence, lines, start = line[3:].strip() or "text", [], number + 1
        elif line.strip():
            before = line.strip()


def run(page: Path) -> None:
    """Does what a page says.

    Raises:
        AssertionError: A command fails, or its program is not known here.
    """
    namespace = {"__name__": "__main__"}
    for room in ("controllers", "sensors"):  # so that a file saved there is one of the room's modules
        import_module(f"drake_twin.{room}").__path__.append(str(Path.cwd() / "drake_twin" / room))
    for block in blocks(page):
        if block.file is not None:
            file = Path(block.file)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(block.text, encoding="utf-8")
        elif block.language == "python":
            exec(compile("\n" * (block.line - 1) + block.text, str(page), "exec"), namespace)
        elif block.language == "sh":
            for line in block.text.replace("\\\n", " ").splitlines():
                command(line, f"{page.name}:{block.line}")
        elif block.language == "yaml":
            yaml.safe_load(block.text)
        elif block.language == "json":
            json.loads(block.text)


def command(line: str, place: str) -> None:
    """Runs a line of a shell block."""
    words = shlex.split(line, comments=True)
    text = shlex.join(words)
    if not words or text.startswith((*OTHERS, *ELSEWHERE)):
        return
    if text.startswith("python -m pytest") and Path(words[-1]).is_file():
        import pytest

        assert pytest.main(["-q", "-n0", "-p", "no:cacheprovider", *words[3:]]) == 0, f"{place}: {line}"
        return
    if text.startswith(TOO_LONG):
        return
    if words[0] == "drake-twin":
        words = ["python", "-m", f"drake_twin.{words[1]}", *words[2:]]
    assert words[:2] == ["python", "-m"], f"{place}: what is {line!r}?"
    program, arguments = words[2], [word for word in words[3:] if word != "[--strict]"]
    assert program in (
        "drake_twin",
        *(f"drake_twin.{name}" for name in ("run", "check", "play", "sweep", "calibrate", "mirror")),
    ), f"{place}: what is {line!r}?"
    if program == "drake_twin":
        program, arguments = f"drake_twin.{arguments[0]}", arguments[1:]
    # A mirror learns from a minute of a robot: tests/mirror does what the page says.
    if any("path/to" in word or word in WAITS or word == "PACKAGE" for word in arguments) or program == MIRROR:
        check_options(program, arguments, place)
        return
    if program == "drake_twin.run":
        arguments.append("--headless")
        if "--end-with-recording" not in arguments and "--episode" not in arguments:
            arguments += ["--duration", "0.05"]
    if "--plugin" in arguments:  # a process of its own, as the page's programs import the module, too
        code = subprocess.run([sys.executable, "-m", program, *arguments], check=False).returncode
    else:
        code = import_module(program).main(arguments)
    assert code == 0, f"{place}: {line}"


def check_options(program: str, arguments: list[str], place: str) -> None:
    """Checks that the program of a command that is not run has its options."""
    said = io.StringIO()
    for each in (program, "drake_twin.run") if program == MIRROR else (program,):
        with contextlib.redirect_stdout(said), contextlib.suppress(SystemExit):
            import_module(f"{each}.__main__" if each == MIRROR else each).main(["--help"])
    for word in arguments:
        if word.startswith("--"):
            assert word.partition("=")[0] in said.getvalue(), f"{place}: {program} has no option {word}"


if __name__ == "__main__":
    sys.path.insert(0, "")
    run(Path(sys.argv[1]))
