"""The benchmarks run, and compare the same robots: what the engines calculate agrees."""

import json
from importlib.util import find_spec

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="mujoco is not installed: pip install '.[benchmarks]'")

from drake_twin.benchmarks.__main__ import main
from drake_twin.benchmarks.engine import Setting, drive
from drake_twin.benchmarks.sections import SECTIONS
from drake_twin.benchmarks.workloads import WORKLOADS

SETTINGS = [
    Setting("twin", 0.001),
    Setting("twin, cenic", 0.1, 1e-3),
    Setting("bare plant", 0.001),
    Setting("bare plant, sampled ports", 0.001),
    Setting("MuJoCo", 0.0005),
    *([Setting("PyBullet", 0.001)] if find_spec("pybullet") else []),  # it has no wheel for Python 3.12 and later
]


@pytest.mark.parametrize("setting", SETTINGS, ids=str)
@pytest.mark.parametrize("name", WORKLOADS)
def test_every_engine_moves_the_same_robots_alike(name, setting, tmp_path):
    """Wheels slip when they start, so engines of different contact models differ there, and by so much only."""
    workload = WORKLOADS[name]
    engine = setting.make(workload, 2, tmp_path)
    drive(engine, workload, 2, 0.0, 1.3)
    times = np.linspace(0, 1.3, 1301) if workload.period is None else np.floor(np.linspace(0, 1.29, 1291) / 0.1) * 0.1
    wanted = np.mean([workload.commands(2, time) for time in times], axis=0) * 1.3
    apart = np.abs(engine.positions() - wanted).max()
    assert np.abs(wanted).max() > 0.3
    assert apart < (0.25 if workload.robot == "rover" else 0.05)


def test_a_bare_plant_is_the_twins_plant(tmp_path):
    workload = WORKLOADS["cruising rovers"]
    engines = [Setting(name, 0.001).make(workload, 2, tmp_path) for name in ("twin", "bare plant")]
    for engine in engines:
        drive(engine, workload, 2, 0.0, 0.5)
    np.testing.assert_allclose(engines[0].positions(), engines[1].positions(), atol=1e-9)


def test_events_are_on_their_grid_and_commands_with_them(tmp_path):
    class Counting:
        def __init__(self):
            self.commanded, self.stops = [], []

        def command(self, velocities):
            self.commanded.append(velocities)

        def advance_to(self, time):
            self.stops.append(time)

    counting = Counting()
    drive(counting, WORKLOADS["rovers whose commands change"], 1, 0.0, 0.3, 0.05)
    assert counting.stops == pytest.approx([0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.3])
    assert len(counting.commanded) == 3
    counting.stops.clear()
    drive(counting, WORKLOADS["rovers whose commands change"], 1, 0.3, 0.5, 0.05)
    assert counting.stops == pytest.approx([0.35, 0.4, 0.45, 0.5, 0.5])
    assert len(counting.commanded) == 5


@pytest.mark.slow
def test_a_quick_run_of_all_sections_is_saved(tmp_path, capfd):
    assert main(["--quick", "--output", str(tmp_path)]) == 0
    saved = json.loads((tmp_path / "benchmarks.json").read_text())
    assert {table["section"].replace(" ", "-") for table in saved["tables"]} == set(SECTIONS)
    assert all(len(row) == len(table["columns"]) for table in saved["tables"] for row in table["rows"])
    assert "Drake" in (tmp_path / "benchmarks.md").read_text()
    assert {file.suffix for file in tmp_path.iterdir()} == {".json", ".md", ".svg"}


@pytest.mark.slow
def test_as_many_robots_run_as_somebody_asks_for(tmp_path):
    assert main(["robots", "real-time", "--quick", "--robots", "3", "--output", str(tmp_path)]) == 0
    tables = json.loads((tmp_path / "benchmarks.json").read_text())["tables"]
    assert [[row[0] for row in table["rows"]] for table in tables] == [[3]] * 6


@pytest.mark.parametrize(
    ("arguments", "text"),
    [(["speed"], "unknown section 'speed'"), (["--robots", "some"], "expected numbers from 1 on")],
)
def test_wrong_arguments_are_explained(arguments, text, capsys):
    assert main(arguments) == 2
    assert text in capsys.readouterr().err
