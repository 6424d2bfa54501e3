"""Which tests run every day: the lists in conftest.py and thorough_tests.txt name tests that exist."""

import ast

import pytest
from conftest import FAST_ROOMS, TESTS, THOROUGH, TOO_SLOW_FOR_FAST


def functions(file):
    """The tests of a file, as pytest names them."""
    for node in ast.parse((TESTS / file).read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ClassDef):
            yield from (f"{node.name}::{item.name}" for item in node.body if isinstance(item, ast.FunctionDef))
        if isinstance(node, ast.FunctionDef):
            yield node.name
        if isinstance(node, ast.Assign):
            yield from (target.id for target in node.targets if isinstance(target, ast.Name))
        if isinstance(node, ast.ImportFrom):  # the page's tests in Firefox are imported
            yield from (alias.name for alias in node.names)


@pytest.mark.parametrize("file", sorted({name.partition("::")[0] for name in THOROUGH}))
def test_each_test_of_the_thorough_lane_exists(file):
    listed = {name.partition("::")[2] for name in THOROUGH if name.startswith(f"{file}::")}
    assert listed - set(functions(file)) == set()


def test_each_room_and_file_that_the_fast_lane_names_exists():
    assert [room for room in FAST_ROOMS if not (TESTS / room).is_dir()] == []
    assert [stem for stem in TOO_SLOW_FOR_FAST if not [*TESTS.rglob(f"{stem}.py")]] == []
