"""Work and precision: the fastest run of each engine among those that are as exact as asked for."""

from types import SimpleNamespace

import numpy as np
import pytest

from drake_twin.benchmarks import precision as module
from drake_twin.benchmarks.engine import Setting
from drake_twin.benchmarks.precision import _Case, equal_error, precision
from drake_twin.benchmarks.size import Size
from drake_twin.benchmarks.workloads import WORKLOADS

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
    """The cases that were measured, and their settings."""
    cases = []

    def run(case, setting):
        cases.append((case._workload.name, case._count, case._event, setting))
        error, factor = RUNS.get(setting, (0.0, 1.0))
        return np.full(4, 1.0 + error), factor

    ladders = [[setting for setting in RUNS if setting.engine == name] for name in ("twin", "MuJoCo")]
    monkeypatch.setattr(module, "compared", lambda: ["twin", "MuJoCo"])
    monkeypatch.setattr(_Case, "_run", run)
    monkeypatch.setattr(_Case, "ladders", lambda case, solvers: ladders)
    monkeypatch.setattr(_Case, "_costs", lambda case, chosen: {name: 1e3 / RUNS[at][1] for name, at in chosen.items()})
    return cases


def test_the_fastest_of_those_that_are_exact_enough_are_compared(measured, tmp_path, capsys):
    best, *tables = precision(Size(tmp_path, counts=(2,)))
    assert best.columns == ("work", "twin at", "µs/ms", "MuJoCo at", "µs/ms", "twin ÷ MuJoCo")
    assert {row[0].partition(",")[0] for row in best.rows} == {f"2 {name}" for name in WORKLOADS}
    for row in best.rows:
        assert row[1:] == ("1 ms", pytest.approx(1e3 / 60), "2 ms", pytest.approx(1e3 / 30), pytest.approx(30 / 60))
    assert len(tables) == len(best.rows)
    assert [row[1:] for row in tables[0].rows] == [(f"{error:.1e}", factor) for error, factor in RUNS.values()]
    told = capsys.readouterr().err.splitlines()
    assert [line.strip() for line in told] == [row[0].partition(",")[0] for row in best.rows]
    assert {event for name, _, event, _ in measured if name == "cruising rovers"} == {None, module.EVENT}


def test_the_search_ends_at_the_first_setting_that_is_exact_enough(measured, tmp_path):
    (table,) = equal_error(Size(tmp_path, counts=(3,)))
    assert [row[0] for row in table.rows] == [
        f"3 {name}" for name in (*WORKLOADS, "towers of ten boxes", "boxes at rest")
    ]
    assert {row[1:4] for row in table.rows} == {("10 ms", 1e3 / 40, "2 ms")}
    assert Setting("twin", 0.001) not in {setting for *_, setting in measured}
    assert Setting("twin", 0.02) in {setting for *_, setting in measured}


def test_where_an_engine_is_nowhere_exact_enough_there_is_no_setting(measured, tmp_path, monkeypatch):
    monkeypatch.setitem(RUNS, Setting("twin", 0.01), (1.0, 40.0))
    monkeypatch.setitem(RUNS, Setting("twin", 0.001), (1.0, 60.0))
    best, *_ = precision(SimpleNamespace(counts=(1,), scale=1.0))
    assert {(row[1], row[2], row[-1]) for row in best.rows} == {("none", None, None)}


def test_rovers_are_measured_in_all_numbers_and_others_in_the_first_two(measured, tmp_path):
    precision(Size(tmp_path, counts=(1, 2, 3)))
    counts = {name: {count for of, count, _, _ in measured if of == name} for name in WORKLOADS}
    assert counts == {name: {1, 2, 3} if name == "cruising rovers" else {1, 2} for name in WORKLOADS}


@pytest.mark.parametrize("event", [None, module.EVENT])
@pytest.mark.parametrize("count", [1, 32])
def test_each_setting_is_tried_once_and_the_finest_run_is_finer_than_all(count, event, tmp_path, monkeypatch):
    """Discrete engines are of first order: at a quarter of a step they have a quarter of its error."""
    monkeypatch.setattr(module, "compared", lambda: ["twin", "DART", "MuJoCo"])
    case = _Case(Size(tmp_path), WORKLOADS["cruising rovers"], count, event)
    ladders = case.ladders(module._SOLVERS)
    assert {ladder[0].engine for ladder in ladders} == {*module._SOLVERS, "twin, cenic", "DART", "MuJoCo"}
    for own in ladders:
        sizes = [setting.step if setting.accuracy is None else setting.accuracy for setting in own]
        assert sizes == sorted(set(sizes), reverse=True)
        assert len(own) > 5
        finest = case._finest(own[0].engine)
        assert {truth.engine for truth in finest} == {own[0].engine} == {setting.engine for setting in own}
        truths = [truth.step if truth.accuracy is None else truth.accuracy for truth in finest]
        assert max(truths) <= sizes[-1]
        assert min(truths) <= sizes[-1] / 2
        if event is not None and own[0].accuracy is not None:
            assert {setting.step for setting in own} == {event}
