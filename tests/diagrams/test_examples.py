"""Each example in diagrams/ runs with the command in its first lines, and so do the notebook's cells in order."""

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

DIAGRAMS = Path(__file__).resolve().parents[2] / "diagrams"
COMMAND = re.compile(r"(?:Run it: +|runs with `+)(python [^`\n]+)")
PICTURES = (".svg", ".png")
WORLDS = ("crates.sdf",)
# They need a twin or a ROS 2: test_commander.py and test_nav2_and_moveit.py run them.
BESIDE = ("commander.py", "nav2_and_moveit.py")
EXAMPLES = sorted(
    file.name for file in DIAGRAMS.iterdir() if file.is_file() and file.suffix not in (*PICTURES, ".ipynb", ".sdf")
)


def command_of(example: str) -> list[str]:
    first_lines = "\n".join((DIAGRAMS / example).read_text().splitlines()[:8])
    (command, *_) = COMMAND.findall(first_lines)
    return shlex.split(command)


@pytest.mark.parametrize("example", [example for example in EXAMPLES if example not in BESIDE])
def test_an_example_runs_with_the_command_in_its_first_lines(example):
    _, *words = command_of(example)
    if words[:2] == ["-m", "drake_twin.run"]:
        words += ["--headless", "--duration", "0.2"]
    assert f"diagrams/{example}" in words
    run = subprocess.run(
        [sys.executable, *words], cwd=DIAGRAMS.parent, capture_output=True, text=True, timeout=120, check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr
    assert run.stdout


def test_there_are_at_least_ten_examples_and_every_world_is_used():
    assert len(EXAMPLES) >= 10
    texts = [(DIAGRAMS / example).read_text() for example in EXAMPLES]
    for world in WORLDS:
        assert any(world in text for text in texts)
    assert {file.name for file in DIAGRAMS.glob("*.sdf")} == set(WORLDS)


def test_the_page_of_examples_lists_each_of_them():
    page = (DIAGRAMS.parent / "drake_twin" / "docs" / "examples.md").read_text()
    assert set(re.findall(r"`diagrams/([\w.]+)`", page)) >= {*EXAMPLES, "tour.ipynb"}


def test_the_notebooks_cells_run_in_order():
    notebook = json.loads((DIAGRAMS / "tour.ipynb").read_text())
    program = "\n\n".join("".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code")
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=120, cwd=DIAGRAMS, check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr


def test_the_notebook_has_no_outputs_and_its_links_lead_to_headings():
    notebook = json.loads((DIAGRAMS / "tour.ipynb").read_text())
    assert all(cell.get("outputs", []) == [] for cell in notebook["cells"])
    text = "\n".join("".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "markdown")
    headings = {heading.replace(" ", "-") for heading in re.findall(r"^#+ (.+)$", text, re.MULTILINE)}
    assert set(re.findall(r"\]\(#([^)]+)\)", text)) <= headings
