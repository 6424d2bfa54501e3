"""Tables of results in Markdown and JSON."""

import json

import pytest

pytest.importorskip("mujoco", reason="mujoco is not installed: pip install '.[benchmarks]'")

from drake_twin.benchmarks.report import Table, machine, save

TABLE = Table(
    "robots",
    "Rovers: as fast",
    ("what", "factor"),
    (("a", 1.23456), ("b", 123.456), ("c", 7), ("d", None), ("e", -250.4)),
)


def test_numbers_have_three_digits_or_none_behind_the_point():
    assert TABLE.markdown().splitlines() == [
        "### Rovers: as fast",
        "",
        "| what | factor |",
        "| --- | --- |",
        "| a | 1.23 |",
        "| b | 123 |",
        "| c | 7 |",
        "| d | – |",
        "| e | -250 |",
    ]


def test_tables_are_saved_with_the_machine(tmp_path):
    save([TABLE], tmp_path / "new")
    saved = json.loads((tmp_path / "new" / "benchmarks.json").read_text())
    assert saved["tables"][0]["rows"] == [["a", 1.23456], ["b", 123.456], ["c", 7], ["d", None], ["e", -250.4]]
    assert saved["machine"] == machine()
    assert {"drake", "mujoco", "processor", "Python"} <= saved["machine"].keys()
    text = (tmp_path / "new" / "benchmarks.md").read_text()
    assert text.startswith("Measured on: ")
    assert TABLE.markdown() in text
