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


def test_rovers_are_measured_in_all_numbers_and_others_in_the_first_two(measured, tmp_path):
    best, *_ = sections.precision(Size(tmp_path, counts=(1, 2, 3)))
    counts = {name: {row[1] for row in best.rows if row[0] == name} for name in sections.WORKLOADS}
    assert counts == {name: {1, 2, 3} if name == "cruising rovers" else {1, 2} for name in sections.WORKLOADS}


@pytest.mark.parametrize("event", [None, sections.EVENT])
@pytest.mark.parametrize("count", [1, 32])
def test_each_setting_is_tried_once_and_the_finest_run_is_finer_than_all(count, event):
    """Discrete engines are of first order: at a quarter of a step they have a quarter of its error."""
    finest, tried = sections._settings(count, event, coarse=False)
    assert len(set(tried)) == len(tried)
    for engine, truths in finest.items():
        own = [setting for setting in tried if setting.engine == engine]
        sizes = [setting.step if setting.accuracy is None else setting.accuracy for setting in own]
        assert sizes == sorted(sizes, reverse=True)
        assert len(own) > 5
        for truth in truths:
            assert (truth.step if truth.accuracy is None else truth.accuracy) <= sizes[-1]
        best = min(truth.step if truth.accuracy is None else truth.accuracy for truth in truths)
        assert best <= sizes[-1] / 2
        if event is not None and own[0].accuracy is not None:
            assert {setting.step for setting in own} == {event}


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
