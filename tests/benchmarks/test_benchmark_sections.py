"""Work and precision: the fastest run of each engine among those that are as exact as asked for."""

from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="mujoco is not installed: pip install '.[benchmarks]'")

from drake_twin.benchmarks import sections
from drake_twin.benchmarks.engine import Setting
from drake_twin.benchmarks.size import Size

TRUTH = {"twin": Setting("twin", 1e-5), "MuJoCo": Setting("MuJoCo", 1e-5)}
# Error (rad) and real-time factor of each.
RUNS = {
    Setting("twin", 0.02): (5e-3, 90.0),
    Setting("twin", 0.01): (8e-4, 40.0),
    Setting("twin", 0.001): (1e-5, 60.0),  # finer, and faster
    Setting("MuJoCo", 0.005): (2e-3, 80.0),
    Setting("MuJoCo", 0.002): (9e-4, 30.0),
}


@pytest.fixture
def measured(monkeypatch):
    """The cases that were measured."""
    cases = []

    def run(size, setting, workload, count, event):
        cases.append((workload.name, count, event))
        error, factor = RUNS.get(setting, (0.0, 1.0))
        return np.full(4, 1.0 + error), factor

    monkeypatch.setattr(sections, "_run", run)
    monkeypatch.setattr(
        sections, "_settings", lambda *_, **__: ({name: [item] for name, item in TRUTH.items()}, [*RUNS])
    )
    monkeypatch.setattr(
        sections, "_factor", lambda size, settings, *_: {setting: RUNS[setting][1] for setting in settings}
    )
    return cases


def test_the_fastest_of_those_that_are_exact_enough_are_compared(measured, tmp_path, capsys):
    best, *tables = sections.precision(Size(tmp_path, counts=(2,)))
    names = [row[0] for row in best.rows]
    assert set(names) == set(sections.WORKLOADS)
    for row in best.rows:
        summary = dict(zip(best.columns, row, strict=False))
        assert summary["twin's setting"] == str(Setting("twin", 0.001))
        assert summary["MuJoCo's step"] == str(Setting("MuJoCo", 0.002))
        assert row[-1] == pytest.approx(60 / 30)
    assert len(tables) == len(best.rows)
    assert [row[1:] for row in tables[0].rows] == [(f"{error:.1e}", factor) for error, factor in RUNS.values()]
    told = capsys.readouterr().err.splitlines()
    assert [line.strip() for line in told] == [f"2 {name}" for name in names]
    assert {event for name, _, event in measured if name == "cruising rovers"} == {None, sections.EVENT}


def test_where_the_twin_is_nowhere_exact_enough_there_is_no_setting(measured, tmp_path, monkeypatch):
    monkeypatch.setitem(RUNS, Setting("twin", 0.01), (1.0, 40.0))
    monkeypatch.setitem(RUNS, Setting("twin", 0.001), (1.0, 60.0))
    best, *_ = sections.precision(SimpleNamespace(counts=(1,), scale=1.0))
    assert {(row[4], row[5], row[8]) for row in best.rows} == {("none", None, None)}


def test_each_feature_runs_as_long_as_nothing_does(monkeypatch, tmp_path):
    twins, make = [], sections._twin

    def kept(*arguments):
        twins.append(make(*arguments))
        return twins[-1]

    monkeypatch.setattr(sections, "_twin", kept)
    (table,) = sections.features(Size(tmp_path, repeats=2, counts=(1,), scale=0.2))
    assert len(twins) == len(table.rows) + 1
    assert {round(twin.time, 9) for twin in twins} == {0.3}  # a tenth of a second for each turn after the first one
    assert all(cost > 0 for _, cost in table.rows)
