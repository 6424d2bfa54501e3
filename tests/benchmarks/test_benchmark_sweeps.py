"""A sweep in the twin and in MuJoCo: both build in an episode before those that are timed."""

import numpy as np
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


def test_each_setting_is_tried_once_and_the_finest_run_is_four_times_finer():
    """Engines of first order have a quarter of the error there."""
    assert len(set(sweeps._TRIED)) == len(sweeps._TRIED)
    for truth in sweeps._FINEST:
        own = [setting for setting in sweeps._TRIED if setting.engine == truth.engine]
        sizes = [setting.step if setting.accuracy is None else setting.accuracy for setting in own]
        assert sizes == sorted(sizes, reverse=True)
        assert (truth.step if truth.accuracy is None else truth.accuracy) <= sizes[-1] / 4


def test_the_fastest_of_those_that_are_exact_enough_is_chosen(monkeypatch, tmp_path):
    """Of each engine; where none is exact enough, the nearest to its own finest run."""
    errors = {0.01: 2e-3, 0.001: 8e-4, 0.0005: 5e-4, 0.0002: 1e-4}

    def positions(setting, size):
        if setting in sweeps._FINEST:
            return np.zeros((2, 4))
        return np.full((2, 4), errors[setting.step] if setting.engine == "twin" else 5.0 + setting.step)

    def timed(cases, repeats):
        return {name: [1.0 if name == "twin 1 ms" else 2.0] for name in cases}

    monkeypatch.setattr(sweeps, "_positions", positions)
    monkeypatch.setattr(sweeps, "by_turns", timed)
    ours, theirs = sweeps._equally_accurate(Size(tmp_path))
    assert ours == Setting("twin", 0.001)
    assert theirs == Setting("MuJoCo", 0.00005)
