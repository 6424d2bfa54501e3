"""Files that an earlier version of this software saved (its commit 5e8afd8) still load, and go on as they did there."""

import json
from pathlib import Path

import numpy as np
import pytest

from drake_twin import InputError, Recording, Snapshot, Twin, replay
from drake_twin.findings import Kind
from drake_twin.scenario.scenario_file import ScenarioFile

FILES = Path(__file__).parent / "version_1"

# As that version said at the end of the recorded run, at 1.5 s (rad, m).
AT_THE_END = (0.5004713940959125, -0.49949777588914634, 0.5959999999999966, 1.004000000000004, 0.049969073090474485)


@pytest.fixture
def saved(tmp_path):
    for file in FILES.iterdir():
        (tmp_path / file.name).write_text(file.read_text().replace("FOLDER", str(tmp_path)))
    return tmp_path


def test_a_saved_state_is_gone_back_to(saved):
    snapshot = Snapshot.load(saved / "state.json")
    twin = Twin(ScenarioFile(snapshot.scenario, "state").scenario)
    twin.restore(snapshot)
    joints = json.loads((FILES / "state.json").read_text())["robots"]["used"]["joints"]
    state = twin.robot_state("used")
    assert state.positions == tuple(position for position, _ in joints.values())
    assert state.velocities == tuple(velocity for _, velocity in joints.values())
    twin.advance_to(1.2)  # the trajectory of the goal that was on its way ends at 1.1 s
    assert np.abs(np.subtract(twin.robot_state("used").positions[:2], (0.5, -0.5))).max() < 5e-3


def test_a_recording_is_done_again_and_ends_where_it_ended(saved):
    twin = replay(Recording.load(saved / "recording.json"))
    assert twin.time == pytest.approx(1.5)
    # A wheel that comes to rest stops up to 1.5e-3 rad earlier since: its brake has changed.
    assert twin.robot_state("used").positions == pytest.approx(AT_THE_END, abs=2e-3)


def test_what_was_not_started_then_is_a_finding_now(saved):
    data = json.loads((saved / "state.json").read_text())
    data["scenario"] += "\nnot_started:\n  - rviz2 (no window)\n"
    (saved / "state.json").write_text(json.dumps(data))
    scenario = ScenarioFile(Snapshot.load(saved / "state.json").scenario, "state").scenario
    assert [(finding.kind, finding.what) for finding in scenario.findings] == [(Kind.NOT_STARTED, "rviz2 (no window)")]


def test_a_version_of_the_future_is_refused(saved):
    data = json.loads((saved / "state.json").read_text())
    (saved / "state.json").write_text(json.dumps(data | {"version": 4}))
    with pytest.raises(InputError, match="has version 4; 1 to 3 can be read"):
        Snapshot.load(saved / "state.json")
