"""Features are timed over the same span."""

import pytest

pytest.importorskip("mujoco", reason="mujoco is not installed: pip install '.[benchmarks]'")

from drake_twin.benchmarks import sections
from drake_twin.benchmarks.size import Size


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
