"""Figures of results: what is drawn of which table."""

import xml.etree.ElementTree as ET

from drake_twin.benchmarks.plots import draw
from drake_twin.benchmarks.report import Table

ROBOTS = Table("robots", "Real time: cruising rovers", ("robots", "twin", "MuJoCo"), ((1, 30.0, 60.0), (8, 4.0, 9.0)))
PRECISION = Table(
    "precision",
    "Work and precision: 2 arms",
    ("setting", "error (rad)", "real-time factor"),
    (("twin 1 ms", "1e-3", 40.0), ("twin, cenic 1e-3", "1e-4", 30.0), ("MuJoCo 2 ms", "1e-2", 90.0)),
)


def words(file):
    """The text in an SVG file."""
    return {"".join(node.itertext()).strip() for node in ET.parse(file).iter("{http://www.w3.org/2000/svg}text")}


def test_each_kind_of_table_has_its_figure(tmp_path):
    assert draw([ROBOTS, PRECISION, ROBOTS], tmp_path) == [tmp_path / "robots.svg", tmp_path / "precision.svg"]
    assert {"cruising rovers", "robots", "real-time factor", "twin", "MuJoCo"} <= words(tmp_path / "robots.svg")
    expected = {"2 arms", "error (rad)", "real-time factor", "twin", "twin, cenic", "MuJoCo"}
    assert expected <= words(tmp_path / "precision.svg")


def test_real_time_is_a_grey_line(tmp_path):
    """Grey 0.6 is #999999."""
    draw([ROBOTS, PRECISION], tmp_path)
    assert "#999999" in (tmp_path / "robots.svg").read_text()
    assert "#999999" not in (tmp_path / "precision.svg").read_text()


def test_other_tables_have_none(tmp_path):
    assert draw([Table("startup", "Phases of a start", ("phase", "ms"), (("a", 1.0),))], tmp_path) == []
    assert [*tmp_path.iterdir()] == []
