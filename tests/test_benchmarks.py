"""The benchmarks run, and compare the same robots: what the engines calculate agrees."""

import json

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="mujoco is not installed: pip install '.[benchmarks]'")

from drake_twin.benchmarks import __main__ as program
from drake_twin.benchmarks import engine as engines
from drake_twin.benchmarks.__main__ import main
from drake_twin.benchmarks.engine import OPTIONAL_MODULES, Setting, drive, is_present
from drake_twin.benchmarks.piles import PILES
from drake_twin.benchmarks.sections import SECTIONS
from drake_twin.benchmarks.workloads import PILLAR, WORKLOADS

SETTINGS = [
    Setting("twin", 0.001),
    Setting("twin, cenic", 0.1, 1e-3),
    Setting("bare plant", 0.001),
    Setting("bare plant, sampled ports", 0.001),
    Setting("MuJoCo", 0.0005),
    *(Setting(name, 0.001) for name in OPTIONAL_MODULES if is_present(name)),
]
COMPARED = [setting for setting in SETTINGS if setting.engine in ("twin", "MuJoCo", *OPTIONAL_MODULES)]


@pytest.mark.parametrize("setting", SETTINGS, ids=str)
@pytest.mark.parametrize("name", WORKLOADS)
def test_every_engine_moves_the_same_robots_alike(name, setting, tmp_path):
    """Wheels slip when they start, so engines of different contact models differ there, and by so much only."""
    workload = WORKLOADS[name]
    engine = setting.make(workload, 2, tmp_path)
    drive(engine, workload, 2, 0.0, 1.3)
    wanted = np.sum([0.1 * workload.commands(2, index * 0.1) for index in range(13)], axis=0)
    apart = np.abs(engine.positions() - wanted).max()
    assert np.abs(wanted).max() > 0.3
    assert apart < (0.25 if workload.robot == "rover" else 0.005)


@pytest.mark.parametrize("setting", [Setting("twin", 0.001), Setting("MuJoCo", 0.002)], ids=str)
def test_arms_follow_the_integral_of_their_commands(setting, tmp_path):
    """At every tenth of a second, at the engine's default step."""
    workload = WORKLOADS["arms whose commands change"]
    engine = setting.make(workload, 2, tmp_path)
    wanted = np.zeros((2, 4))
    for index in range(13):
        begin = index * 0.1
        drive(engine, workload, 2, begin, begin + 0.1)
        wanted += 0.1 * workload.commands(2, begin)
        np.testing.assert_allclose(engine.positions(), wanted, atol=0.003)
    assert np.abs(wanted).max() > 0.3


@pytest.mark.parametrize("setting", COMPARED, ids=str)
def test_arms_push_pillars_in_every_engine(setting, tmp_path):
    """Most of DART's pairs of bodies get lost where one of them reaches through its plane z = 0."""
    workload = WORKLOADS["arms that push boxes"]
    engine = setting.make(workload, 2, tmp_path)
    begin = engine.centers()
    np.testing.assert_allclose(begin, [PILLAR[0].xyz, np.add(PILLAR[0].xyz, (0, 1.5, 0))], atol=1e-6)
    drive(engine, workload, 2, 0.0, 1.0)
    assert (np.linalg.norm(engine.centers() - begin, axis=1) > 0.1).all()


@pytest.mark.parametrize("setting", COMPARED, ids=str)
def test_boxes_stand_at_their_height_in_every_engine(setting, tmp_path):
    tower, row = PILES["towers of ten boxes"], PILES["boxes at rest"]
    for workload, count, heights in ((tower, 1, 0.1 + 0.2 * np.arange(10)), (row, 3, np.full(3, 0.1))):
        engine = setting.make(workload, count, tmp_path)
        drive(engine, workload, count, 0.0, 0.2)
        centers = engine.centers()
        assert (np.abs(centers[:, 2] - heights) < 1e-3 * np.arange(1, len(heights) + 1)).all()
        np.testing.assert_allclose(centers[:, :2], [box.xyz[:2] for box in workload.pile(count)], atol=5e-4)


@pytest.mark.parametrize("setting", COMPARED, ids=str)
def test_boxes_fall_onto_a_heap_in_every_engine(setting, tmp_path):
    workload = PILES["boxes in heaps of twenty"]
    engine = setting.make(workload, 4, tmp_path)
    np.testing.assert_allclose(engine.centers(), [box.xyz for box in workload.pile(4)], atol=1e-6)
    drive(engine, workload, 4, 0.0, 1.2)
    heights = engine.centers()[:, 2]
    assert heights.min() > 0.05 - 1e-3  # half of the shortest edge
    assert heights.max() < 0.36  # as high as four that stand on their longest sides


@pytest.mark.parametrize("module", ["dartpy", "pybullet"])
def test_an_engine_without_a_package_is_left_out_and_said(module, tmp_path, monkeypatch, capsys):
    def find(name, found=engines.find_spec):
        return None if name == module else found(name)

    monkeypatch.setattr(engines, "find_spec", find)
    monkeypatch.setattr(program, "find_spec", find)
    monkeypatch.setattr(program.sys, "version_info", (3, 13))
    monkeypatch.setattr(program, "SECTIONS", {"engines": lambda size: []})
    assert main(["--output", str(tmp_path)]) == 0
    name = next(name for name, needed in OPTIONAL_MODULES.items() if needed == module)
    assert capsys.readouterr().err.count(f"{name} is left out: ") == 1
    assert not is_present(name)
    assert name not in engines.compared()


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
