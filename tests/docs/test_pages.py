"""What the pages say works: their Python, their commands and the files that they have the reader save."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
import run_page

import drake_twin

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "drake_twin" / "docs"
PAGES = [
    page
    for page in (ROOT / "README.md", ROOT / ".github" / "CONTRIBUTING.md", *sorted(DOCS.glob("*.md")))
    if any(block.language in ("python", "sh", "yaml", "json") for block in run_page.blocks(page))
]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_what_a_page_says_works(page, tmp_path):
    command = [sys.executable, run_page.__file__, str(page)]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False)
    assert run.returncode == 0, run.stdout + run.stderr


def test_the_controller_that_contributors_are_shown_has_forty_lines():
    (file,) = [
        block
        for block in run_page.blocks(ROOT / ".github" / "CONTRIBUTING.md")
        if "approach_controller" in str(block.file)
    ][:1]
    assert file.file == "drake_twin/controllers/approach_controller.py"
    assert len([line for line in file.text.splitlines() if line]) <= 40


# What draws each picture of the pages.
DRAWN_BY = {
    "drake_twin/docs/two_rovers.png": "tests/docs/draw_page.py",
    "diagrams/two_rovers.svg": "drake_twin/diagram/picture.py",  # python -m drake_twin.run FILE --graphviz PICTURE
    "drake_twin/docs/panels.png": "tests/docs/draw_panel.py",
    "drake_twin/docs/mirror.png": "tests/docs/draw_mirror.py",
    "drake_twin/docs/rovers_and_arm.webp": "tests/docs/draw_page.py",
}


def test_every_picture_is_drawn_by_a_program_of_the_repository():
    shown = {
        str((page.parent / name).resolve().relative_to(ROOT))
        for page in (ROOT / "README.md", *(ROOT / ".github").glob("*.md"), *DOCS.rglob("*.md"))
        for name in re.findall(r"!\[[^\]]*\]\((?!https?:)([^)]+)\)", page.read_text(encoding="utf-8"))
    }
    there = {str(file.relative_to(ROOT)) for kind in ("*.png", "*.svg") for file in (ROOT / "diagrams").glob(kind)}
    ready_made = [*(ROOT / "diagrams").glob("*.yaml"), *(ROOT / "diagrams").glob("*.launch.*")]
    diagrams = {f"diagrams/{file.name.partition('.')[0]}.svg" for file in ready_made}  # tests/diagram compares them
    assert shown == set(DRAWN_BY)
    assert there == diagrams
    places = {"tests": ROOT, "drake_twin": Path(drake_twin.__file__).parents[1]}  # which may be installed elsewhere
    assert all((places[program.partition("/")[0]] / program).is_file() for program in DRAWN_BY.values())


def test_most_pages_have_something_to_run():
    assert {page.stem for page in PAGES} >= {
        *("start", "launch_files", "own_robot", "control", "sensors", "worlds", "physics", "python", "drake"),
        *("extending", "command_line", "page", "panels", "CONTRIBUTING", "README"),
    }


def test_blocks_have_a_language_a_line_and_the_file_named_above_them(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("# A\n\nSave it as `a/b.yaml`:\n\n```yaml\nx: 1\n```\n\n```sh\nls\n```\n```\nplain\n```\n")
    assert list(run_page.blocks(page)) == [
        run_page.Block("yaml", "x: 1\n", 6, "a/b.yaml"),
        run_page.Block("sh", "ls\n", 10, None),
        run_page.Block("text", "plain\n", 13, None),
    ]


@pytest.mark.parametrize(
    "line", ["rm -rf x", "python -m nothing", "python -m drake_twin.run --no-such-option path/to/x"]
)
def test_a_command_that_is_not_known_fails(line):
    with pytest.raises(AssertionError, match=r"what is|no-such-option"):
        run_page.command(line, "page.md:1")
