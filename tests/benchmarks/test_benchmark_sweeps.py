"""A sweep in the twin and in MuJoCo: both build in an episode before those that are timed."""

import pytest

pytest.importorskip("mujoco", reason="mujoco is not installed: pip install '.[benchmarks]'")

from drake_twin.benchmarks import sweeps
from drake_twin.benchmarks.engine import Setting
from drake_twin.benchmarks.size import Size

SETTINGS = Setting("twin", 0.01), Setting("MuJoCo", 0.005)


@pytest.fixture
def runs(monkeypatch):
    """The names of the cases that have run, in their order; two settings are compared."""
    done = []
    for engine, name in (("twin", "_in_twin"), ("MuJoCo", "_in_mujoco")):
        make = getattr(sweeps, name)

        def noted(*arguments, make=make, engine=engine):
            run = make(*arguments)
            return lambda: (run(), done.append(engine))

        monkeypatch.setattr(sweeps, name, noted)
    monkeypatch.setattr(sweeps, "_EQUAL_STEP", SETTINGS)
    monkeypatch.setattr(sweeps, "_equally_accurate", lambda size: SETTINGS)
    return done


def test_both_run_once_before_they_are_timed_by_turns(runs, tmp_path):
    (table,) = sweeps.sweep(Size(tmp_path, repeats=2, scale=0.05))
    assert runs == ["twin", "MuJoCo"] * 3
    assert [row[0] for row in table.rows] == ["equal step", "equal accuracy"]
    for _, ours, rate, theirs, other, quotient in table.rows:
        assert (ours, theirs) == tuple(map(str, SETTINGS))
        assert rate > 0
        assert other > 0
        assert quotient > 0
    assert "episodes of 0.1 s" in table.title
