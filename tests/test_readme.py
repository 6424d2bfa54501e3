import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = [
    ROOT / "README.md",
    *sorted((ROOT / ".github").glob("*.md")),
    *sorted((ROOT / "drake_twin" / "docs").rglob("*.md")),
]


def test_it_is_short():
    assert len(README.splitlines()) <= 150


def test_the_python_of_the_readme_runs_and_its_assertions_hold(capsys):
    program = "\n".join(re.findall(r"```python\n(.*?)```", README, re.DOTALL))
    exec(compile(program, "README.md", "exec"), {})
    printed = capsys.readouterr().out
    assert printed.count("[") == 50  # ten joint states a second for five seconds
    assert re.search(r"^[0-9a-f]{64}$", printed, re.MULTILINE)


def named_paths(page: Path) -> set[Path]:
    """The files and folders that a page names: targets of its links, and quoted paths from the top of the tree."""
    text = page.read_text(encoding="utf-8")
    links = {page.parent / link for link in re.findall(r"\]\((?!https?:)([^)#\s]+)[^)]*\)", text)}
    quoted = re.findall(r"`((?:drake_twin|models|diagrams|tests|\.github|\.ci)/(?:[\w/.-]*/|[\w/.-]+\.\w+)?)`", text)
    return links | {ROOT / path for path in quoted}


# A controller type that looks like a path; and a page that shows how a file is added names it before it is there.
ADDED = {f"{path}/{name}" for path, name in (("drake_twin/controllers", "approach_controller.py"),)} | {
    "tests/controllers/test_approach_controller.py",
    "drake_twin/VectorCommandController",
}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_file_and_folder_that_a_page_names_is_there(page):
    for path in named_paths(page) - {ROOT / name for name in ADDED}:
        assert path.exists(), f"{page.name} names {path.relative_to(ROOT)}"


def test_the_readme_links_to_every_page():
    linked = {path.resolve() for path in named_paths(ROOT / "README.md")}
    pages = {page for page in PAGES if page.parent.name == "docs" and page.name != "index.md"}
    assert pages <= linked


def test_the_ci_calls_the_readmes_commands():
    ci = (ROOT / ".ci" / "run").read_text()
    first, second = re.findall(r"```sh\n(.*?)\n```", README, re.DOTALL)[:2]
    assert first.replace("install .", "install -q .") in ci
    assert second.replace("install '", "install -q '") in ci


def test_the_top_level_is_what_it_is_meant_to_be():
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False)
    if tracked.returncode != 0:
        pytest.skip("this is not a git checkout")
    top = {path.partition("/")[0] for path in tracked.stdout.splitlines()}
    assert {name for name in top if not name.startswith(".")} == {
        "LICENSE", "README.md", "diagrams", "drake_twin", "models", "pyproject.toml", "tests"
    }  # fmt: skip
