"""The rooms of drake_twin and which may import which: an arrow only ever points down this list."""

import ast
import re
from collections import Counter
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import drake_twin

ROOT = Path(drake_twin.__file__).parent

# Modules and packages of the top level, from the top down; those of one line do not import each other.
ROOMS = [
    ["__main__"],
    ["run", "check", "play", "sweep", "calibrate", "tools"],
    ["benchmarks"],
    ["gym"],
    ["mirror"],
    ["calibration"],
    ["sweeps"],
    ["cli"],
    ["show"],
    ["launch", "recording"],  # shorter addresses of what stands in ros2 and twin
    ["builder", "playback"],
    ["cockpit"],
    ["film"],
    ["shared_viewer"],
    ["services", "client"],
    ["wires"],
    ["nodes"],
    ["twin"],
    ["islands"],
    ["diagram"],
    ["planning"],
    ["controllers"],
    ["sensors"],
    ["systems"],
    ["control", "kinematics"],
    ["from_launch"],
    ["ros2"],
    ["scenario"],
    ["description"],
    ["messages"],
    ["program", "progress", "whole_file", "own_host", "scratch_folder"],
    ["python_process", "allocator"],
    ["findings"],
    ["typed_data"],
    ["plugin_watch"],
    ["values", "extensions", "frozen", "requirements", "saved", "versions"],
    ["errors", "dataclass"],
]
RANKS = {room: rank for rank, rooms in enumerate(ROOMS) for room in rooms}
MOST_LINES = 400
MOST_PUBLIC_METHODS = 25

FILES = {
    ".".join(("drake_twin", *file.relative_to(ROOT).with_suffix("").parts)).removesuffix(".__init__"): file
    for file in sorted(ROOT.rglob("*.py"))
    if file.relative_to(ROOT).parts[0] not in ("docs", "share")  # what builds the pages, an installed package's models
}


@cache
def parsed(file: Path) -> ast.Module:
    return ast.parse(file.read_text(encoding="utf-8"))


def imported(module: str) -> Iterator[str]:
    """The package's own modules that a module imports anywhere: in functions and for type checking, too."""
    for node in ast.walk(parsed(FILES[module])):
        names = []
        if isinstance(node, ast.Import):
            names = [item.name for item in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            assert node.level == 0, f"{module} imports relatively"
            names = [f"{node.module}.{item.name}" for item in node.names]
        for name in names:
            while name.startswith("drake_twin") and name not in FILES:
                name = name.rpartition(".")[0]
            if name.startswith("drake_twin.") and name != module:
                yield name


def room(module: str) -> str:
    return module.split(".")[1]


def test_every_room_is_on_the_list():
    found = {path.stem for path in ROOT.iterdir() if path.suffix == ".py" or (path / "__init__.py").exists()}
    assert found - {"__init__"} == set(RANKS)


def test_the_page_of_the_architecture_has_the_same_rooms_in_the_same_order():
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    table = re.findall(r"^\| (`.*?`) \|", page.partition("| room |")[2].partition("## ")[0], flags=re.MULTILINE)
    named = [re.findall(r"`([a-z_0-9]+)`", row) for row in table]
    flat = [room for row in named for room in row]
    assert flat == sorted(flat, key=lambda room: RANKS[room])
    assert set(flat) == set(RANKS) - {"__main__"}


def test_arrows_between_rooms_point_down():
    up = [
        f"{module} → {other}"
        for module in FILES
        if module != "drake_twin"
        for other in imported(module)
        if room(module) != room(other) and RANKS[room(module)] >= RANKS[room(other)]
    ]
    assert up == []


def test_an_arrow_upwards_would_be_seen(monkeypatch, tmp_path):
    file = tmp_path / "errors.py"
    file.write_text("def f():\n    from drake_twin.twin.twin import Twin\n")
    monkeypatch.setitem(FILES, "drake_twin.errors", file)
    assert list(imported("drake_twin.errors")) == ["drake_twin.twin.twin"]
    with pytest.raises(AssertionError, match=r"drake_twin\.errors → drake_twin\.twin\.twin"):
        test_arrows_between_rooms_point_down()


def test_no_files_import_each_other_in_a_circle():
    """Nor for type checking or in functions."""
    arrows = {module: set(imported(module)) for module in FILES if module != "drake_twin"}
    TopologicalSorter(arrows).prepare()  # a CycleError has the files of a circle


def test_a_circle_of_files_would_be_seen(monkeypatch, tmp_path):
    file = tmp_path / "state.py"
    file.write_text("def f():\n    from drake_twin.twin.twin import Twin\n")
    monkeypatch.setitem(FILES, "drake_twin.twin.state", file)
    with pytest.raises(CycleError, match=r"drake_twin\.twin\.twin', 'drake_twin\.twin\.state"):
        test_no_files_import_each_other_in_a_circle()


def test_dataclasses_are_those_that_are_imported_quickly():
    standard = [
        module
        for module, file in FILES.items()
        if re.search(r"^(from dataclasses import .*\bdataclass\b|@dataclasses\.dataclass\b)", file.read_text(), re.M)
    ]
    assert standard == []


def test_planning_and_what_lies_below_the_systems_is_without_drake():
    """Planning asks each kind of controller, whose module needs Drake; it imports none of it itself."""
    rooms = ("planning", "control", "kinematics", "from_launch", "ros2", "scenario", "messages")
    found = []
    for module, file in FILES.items():
        if module != "drake_twin" and room(module) in rooms:
            for node in ast.walk(parsed(file)):
                names = [item.name for item in node.names] if isinstance(node, ast.Import) else []
                names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
                found += [f"{module} → {name}" for name in names if name.startswith("pydrake")]
    assert found == []


def test_each_file_of_systems_works_with_drakes_systems():
    """What does not is a calculation, a message or plain data, and has its own room."""
    files = {module: file.read_text(encoding="utf-8") for module, file in FILES.items() if ".systems." in module}
    assert [name for name, text in files.items() if "from pydrake" not in text] == ["drake_twin.systems.weak_callback"]


def test_no_file_is_long():
    lengths = {module: len(file.read_text(encoding="utf-8").splitlines()) for module, file in FILES.items()}
    assert {module: length for module, length in lengths.items() if length > MOST_LINES} == {}


def test_no_class_has_many_public_methods():
    many = {}
    for module, file in FILES.items():
        if module.startswith(
            ("drake_twin.nodes.rclpy", "drake_twin.nodes.nav2_simple_commander")
        ):  # the methods are those of ROS's classes
            continue
        for node in ast.walk(parsed(file)):
            if isinstance(node, ast.ClassDef):
                methods = {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
                public = {name for name in methods if not name.startswith("_")}
                if len(public) > MOST_PUBLIC_METHODS:
                    many[f"{module}.{node.name}"] = len(public)
    assert many == {}


def test_test_files_of_plain_folders_have_names_of_their_own():
    """Pytest imports them as modules of the top level."""
    files = [file for file in Path(__file__).parent.rglob("test_*.py") if not (file.parent / "__init__.py").exists()]
    names = Counter(file.name for file in files)
    assert [name for name, count in names.items() if count > 1] == []
