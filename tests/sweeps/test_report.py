"""What a table says in text, and the figure of pairs: which values stand against which, and what colors them."""

from itertools import pairwise

import pytest
from matplotlib.figure import Figure

from drake_twin.errors import InputError
from drake_twin.sweeps.report import draw, draw_pairs, report

VARY = [["friction", [0.2, 0.4]], ["payload", [1, 2]], ["gain", [5, 6]]]
ROWS = [
    {"episode": 0, "friction": 0.2, "payload": 1.0, "gain": 5.0, "distance": 0.5},
    {"episode": 1, "friction": 0.4, "payload": 2.0, "gain": 6.0, "distance": 0.7},
    {"episode": 2, "friction": 0.4, "payload": 1.0, "gain": 6.0, "distance": float("nan")},
]


def test_each_two_values_are_drawn_once_and_a_row_without_the_metric_is_left_out(tmp_path, monkeypatch):
    figures = []
    save = Figure.savefig
    monkeypatch.setattr(Figure, "savefig", lambda self, file, **more: (figures.append(self), save(self, file, **more)))
    draw_pairs(tmp_path / "pairs.png", {"vary": VARY}, ROWS)
    assert (tmp_path / "pairs.png").read_bytes().startswith(b"\x89PNG")
    *axes, bar = figures[0].axes
    found = {(axis.get_xlabel(), axis.get_ylabel()): axis.collections[0] for axis in axes}
    assert list(found) == [("friction", "payload"), ("friction", "gain"), ("payload", "gain")]
    assert found["friction", "payload"].get_offsets().tolist() == [[0.2, 1.0], [0.4, 2.0]]
    assert found["payload", "gain"].get_array().tolist() == [0.5, 0.7]
    assert bar.get_ylabel() == "distance"


def test_one_value_makes_no_pair(tmp_path):
    with pytest.raises(InputError, match="--pairs: the table has no metric, or less than two varied numbers"):
        draw_pairs(tmp_path / "pairs.png", {"vary": VARY[:1]}, ROWS)
    assert not (tmp_path / "pairs.png").exists()


def test_the_report_has_the_most_frequent_the_least_and_the_most_telling_first():
    """Outcomes by their number, best and worst rows from the outside in, values by how much a metric follows them."""
    rows = [
        {
            "episode": number,
            "seed": 0,
            "outcome": outcome,
            "reason": reason,
            "weak": weak,
            "strong": strong,
            "distance": distance,
        }
        for number, (outcome, reason, weak, strong, distance) in enumerate(
            [
                ("error", "rare", 1.0, 1.0, None),
                ("done", "", 2.0, 9.0, 0.9),
                ("error", "often", 3.0, 1.0, None),
                ("done", "", 1.0, 7.0, 0.7),
                ("error", "often", 3.0, 1.0, None),
                ("done", "", 3.0, 1.0, 0.1),
                ("done", "", 2.0, 5.0, 0.5),
            ]
        )
    ]
    lines = report({"vary": [["weak", [1, 2, 3]], ["strong", [1, 9]]]}, rows).splitlines()
    assert lines == [
        "7 rows: 4 done, 3 error",
        "distance: least 0.1, median 0.6, largest 0.9",
        "  least   0.1          row 5: weak=3, strong=1, seed 0",
        "  least   0.5          row 6: weak=2, strong=5, seed 0",
        "  least   0.7          row 3: weak=1, strong=7, seed 0",
        "  largest 0.9          row 1: weak=2, strong=9, seed 0",
        "  largest 0.7          row 3: weak=1, strong=7, seed 0",
        "  largest 0.5          row 6: weak=2, strong=5, seed 0",
        "rank correlation of value and metric (1: rises with it, -1: falls with it)",
        "  distance  strong  +1.00",
        "  distance  weak    -0.63",
        "error in 2 rows: often",
        "error in 1 rows: rare",
    ]


def drawn(folder, monkeypatch, pairs):
    """What `draw` makes of values and metrics: the dots, and the line of medians."""
    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda self, file, **more: figures.append(self))
    rows = [{"episode": number, "x": float(x), "y": float(y)} for number, (x, y) in enumerate(pairs)]
    draw(folder / "plot.png", {"vary": [["x", sorted({x for x, _ in pairs})]]}, rows)
    (axis,) = figures[0].axes
    dots, line = axis.get_lines()
    return dots.get_xydata().tolist(), line.get_xydata().tolist()


def test_the_line_goes_through_the_median_of_each_value(tmp_path, monkeypatch):
    pairs = [(1, 10), (1, 30), (1, 20), (2, 5), (2, 7), (4, -1)]
    dots, line = drawn(tmp_path, monkeypatch, pairs)
    assert dots == [list(pair) for pair in pairs]
    assert line == [[1, 20], [2, 6], [4, -1]]


def test_many_values_are_in_bins_of_as_many_rows(tmp_path, monkeypatch):
    dots, line = drawn(tmp_path, monkeypatch, [(x, 2 * x) for x in range(120)])
    assert len(dots) == 120
    assert 5 <= len(line) <= 30
    assert [y for _, y in line] == [2 * x for x, _ in line]
    steps = {round(after[0] - before[0]) for before, after in pairwise(line)}
    assert max(steps) - min(steps) <= 1
    assert line[0][0] < steps.pop()
    assert line[-1][0] > 119 - 120 / len(line)
