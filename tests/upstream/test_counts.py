"""The number of upstream assertions that are held, counted from their tables."""

from importlib import import_module
from pathlib import Path

import pytest

from upstream.differences import DELIBERATE

MODULES = [
    import_module(f"upstream.{path.stem}")
    for path in sorted(Path(__file__).parent.glob("test_*.py"))
    if path.stem != "test_counts"
]
REACHED = 1465


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__.removeprefix("upstream."))
def test_a_file_holds_the_number_of_assertions_that_it_names(module):
    assert len(module.SUITE.lines) == module.ASSERTIONS


def test_the_suites_together_hold_at_least_what_was_reached():
    assert sum(module.ASSERTIONS for module in MODULES) >= REACHED


def test_each_difference_is_one_of_the_held_assertions():
    held = {(module.SUITE.file, line) for module in MODULES for line in module.SUITE.lines}
    assert set(DELIBERATE) <= held
