"""The figure of pairs: which values stand against which, and what colors them."""

import pytest
from matplotlib.figure import Figure

from drake_twin.errors import InputError
from drake_twin.sweeps.report import draw_pairs

VARY = [["friction", [0.2, 0.4]], ["payload", [1, 2]], ["gain", [5, 6]]]
ROWS = [
    {"episode": 0, "friction": 0.2, "payload": 1.0, "gain": 5.0, "distance": 0.5},
    {"episode": 1, "friction": 0.4, "payload": 2.0, "gain": 6.0, "distance": 0.7},
    {"episode": 2, "friction": 0.4, "payload": 1.0, "gain": 6.0, "distance": float("nan")},
]


def test_each_two_values_are_drawn_once_and_a_row_without_the_metric_is_left_out(tmp_path, monkeypatch):
    figures = []
    save = Figure.savefig
    monkeypatch.setattr(Figure, "savefig", lambda self, file: (figures.append(self), save(self, file)))
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
