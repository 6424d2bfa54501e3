"""What is published: the sdist and the wheel, as ``python -m build`` makes them, without network."""

import os
import re
import subprocess
import sys
import tarfile
import zipfile
from dataclasses import dataclass
from email.message import Message
from email.parser import Parser
from importlib.util import find_spec
from pathlib import Path

import pytest

from drake_twin import __version__

ROOT = Path(__file__).resolve().parent.parent
LARGEST = 2_750_000  # bytes
NEEDED = ("build", "hatchling", "hatch_fancy_pypi_readme")
pytestmark = pytest.mark.skipif(
    any(find_spec(name) is None for name in NEEDED), reason="the build tools are not installed: pip install '.[test]'"
)


@dataclass(frozen=True)
class Distributions:
    """The two files, the names in them (the sdist's without its top folder), and the wheel's metadata."""

    sdist: Path
    wheel: Path
    in_sdist: frozenset[str]
    in_wheel: frozenset[str]
    metadata: Message


def build(folder: Path, *options: str) -> Path:
    command = [sys.executable, "-m", "build", "--no-isolation", "-o", str(folder), *options, str(ROOT)]
    run = subprocess.run(command, cwd=folder.parent, capture_output=True, text=True, timeout=300, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    return folder


@pytest.fixture(scope="session")
def made(tmp_path_factory) -> Distributions:
    folder = build(tmp_path_factory.mktemp("distributions") / "dist")
    (sdist,), (wheel,) = folder.glob("*.tar.gz"), folder.glob("*.whl")
    with tarfile.open(sdist) as archive:
        in_sdist = frozenset(name.partition("/")[2] for name in archive.getnames())
    with zipfile.ZipFile(wheel) as archive:
        in_wheel = frozenset(archive.namelist())
        metadata = Parser().parsestr(archive.read(f"drake_twin-{__version__}.dist-info/METADATA").decode())
    return Distributions(sdist, wheel, in_sdist, in_wheel, metadata)


def below(folder: str, *patterns: str) -> set[str]:
    """The checkout's files below a folder, without what Python and editors leave there."""
    files = (file for pattern in patterns for file in (ROOT / folder).rglob(pattern) if file.is_file())
    return {str(file.relative_to(ROOT)) for file in files if "__pycache__" not in file.parts}


def test_they_are_named_after_the_version(made):
    assert made.wheel.name == f"drake_twin-{__version__}-py3-none-any.whl"
    assert made.sdist.name == f"drake_twin-{__version__}.tar.gz"


def test_they_are_small(made):
    sizes = {file.name: file.stat().st_size for file in (made.wheel, made.sdist)}
    print(sizes)
    assert max(sizes.values()) <= LARGEST


def test_the_wheel_has_the_code_the_page_and_the_pages_of_documentation(made):
    code = {name for name in below("drake_twin", "*.py") if not name.startswith("drake_twin/docs/")}
    assert code | below("drake_twin/cockpit/static", "*") | below("drake_twin/docs", "*.md") <= made.in_wheel
    assert "drake_twin/py.typed" in made.in_wheel


def test_the_wheel_has_the_models_and_diagrams(made):
    shared = below("models", "*") | below("diagrams", "*")
    assert {f"drake_twin/share/{name}" for name in shared} <= made.in_wheel


def test_the_wheel_has_nothing_else(made):
    places = {"drake_twin", f"drake_twin-{__version__}.dist-info"}
    assert {name.partition("/")[0] for name in made.in_wheel} == places
    tests = {name for name in made.in_wheel if re.search(r"(^|/)(tests/|conftest|test_)", name)}
    assert tests == {"drake_twin/share/diagrams/test_three_robots.py"}  # an example for users
    assert not [name for name in made.in_wheel if name.startswith("drake_twin/docs/") and not name.endswith(".md")]


def test_the_sdist_has_what_the_wheel_and_the_pages_are_built_from_and_no_tests(made):
    files = below("drake_twin", "*.py", "*.md", "*.svg") | below("models", "*") | below("diagrams", "*")
    assert files | {"LICENSE", "README.md", "pyproject.toml"} <= made.in_sdist
    assert not [name for name in made.in_sdist if name.startswith("tests")]


def test_the_licences_travel(made):
    own, others = ROOT / "LICENSE", ROOT / "drake_twin" / "cockpit" / "static" / "uplot.LICENSE"
    with zipfile.ZipFile(made.wheel) as archive:
        for file in (own, others):
            name = f"drake_twin-{__version__}.dist-info/licenses/{file.relative_to(ROOT)}"
            assert archive.read(name) == file.read_bytes()
    assert made.metadata["License-Expression"] == "Apache-2.0 AND MIT"


def test_code_of_others_has_its_licence_beside_it():
    texts = (ROOT / name for name in below("drake_twin", "*.py", "*.js", "*.css", "*.html"))
    marks = re.compile(r"copyright \(c\)|SPDX-|/\*!", re.IGNORECASE)  # the last begins a comment that minifiers keep
    of_others = [file for file in texts if marks.search(file.read_text(encoding="utf-8"))]
    assert [file.name for file in of_others] == ["uplot.js"]
    assert all(file.with_suffix(".LICENSE").is_file() for file in of_others)


def test_the_description_links_to_nothing_that_the_package_index_lacks(made):
    text = made.metadata.get_payload()
    assert text.startswith("# drake_twin\n")
    assert re.findall(r"\]\((?!https?:)[^)]*\)", text) == []
    assert "pip install drake-twin &&" in text


def test_the_versions_of_python_are_named(made):
    assert made.metadata["Requires-Python"] == ">=3.11"
    named = [text.rpartition(" ")[2] for text in made.metadata.get_all("Classifier") if ":: Python :: 3." in text]
    assert named == ["3.11", "3.12", "3.13"]


def test_the_same_wheel_comes_from_the_checkout_and_from_the_sdist(made, tmp_path):
    (again,) = build(tmp_path / "dist", "--wheel").iterdir()  # the first was made from the unpacked sdist
    assert again.read_bytes() == made.wheel.read_bytes()


def test_the_wheel_runs_its_robots_outside_of_the_checkout(made, tmp_path):
    with zipfile.ZipFile(made.wheel) as archive:
        archive.extractall(tmp_path / "installed")
    run = [sys.executable, "-m", "drake_twin", "run", "--headless", "--duration", "0.1"]
    environment = os.environ | {"PYTHONPATH": str(tmp_path / "installed")}
    where = "import drake_twin; print(drake_twin.__file__)"
    options = {"cwd": tmp_path, "env": environment, "capture_output": True, "text": True, "check": True, "timeout": 120}
    assert str(tmp_path) in subprocess.run([sys.executable, "-c", where], **options).stdout
    for robots in (["--robots", "2"], ["--robot", "arduinobot"], ["diagrams/two_rovers.yaml"]):
        assert "simulated" in subprocess.run([*run, *robots], **options).stdout
