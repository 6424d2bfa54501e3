"""Engines in processes of their own, by turns: what is asked, what comes back, and which numbers are left out."""

from typing import ClassVar

import pytest

pytest.importorskip("mujoco", reason="mujoco is not installed: pip install '.[benchmarks]'")

from drake_twin.benchmarks import comparison
from drake_twin.benchmarks.comparison import engines
from drake_twin.benchmarks.piles import PILES
from drake_twin.benchmarks.size import Size
from drake_twin.benchmarks.worker import WORK, Worker

BOXES = PILES["boxes at rest"]


def test_a_worker_says_what_each_turn_costs_and_ends():
    with Worker("MuJoCo", BOXES, 1) as worker:
        costs = [worker.run(0.1), worker.run(0.1)]
    assert all(0 < cost < 10 for cost in costs)
    assert worker._process.returncode == 0


def test_a_worker_that_has_ended_is_an_error(capfd):
    with (
        Worker("no engine", BOXES, 1) as worker,
        pytest.raises(RuntimeError, match="of no engine with 1 boxes at rest"),
    ):
        worker.run(0.1)
    assert "KeyError" in capfd.readouterr().err


class Counting:
    """A worker whose turns of one robot or box cost one second, and of more in proportion."""

    spans: ClassVar[list] = []

    def __init__(self, engine, workload, count):
        self.workload, self.count = workload, count

    def __enter__(self):
        return self

    def __exit__(self, *error):
        pass

    def run(self, span):
        self.spans.append((self.workload.name, self.count, span))
        return float(self.count)


def test_numbers_whose_turns_would_take_too_long_are_left_out(monkeypatch, tmp_path):
    monkeypatch.setattr(comparison, "Worker", Counting)
    monkeypatch.setattr(comparison, "_megabytes", lambda workload, more, engine: 1.0)
    monkeypatch.setattr(comparison, "compared", lambda: ["twin", "MuJoCo"])
    monkeypatch.setattr(Counting, "spans", [])
    table, memory = engines(Size(tmp_path))
    assert table.columns == ("work", "twin", "MuJoCo", "twin ÷ MuJoCo")
    assert table.rows == tuple((f"{count} {name}", 5e3 * count, 5e3 * count, 1.0) for name in WORK for count in (1, 8))
    assert {row[1:] for row in memory.rows} == {(1.0, 1.0)}
    begins = {span for name, _, span in Counting.spans if name == "boxes in heaps of twenty"}
    assert begins == {WORK["boxes in heaps of twenty"].timed_from, 0.2}
