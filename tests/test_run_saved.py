"""Saved states and recordings of ``drake_twin.run``."""

import json

import pytest
from program_runs import refused, summary_of

from drake_twin.run import main


def test_a_saved_state_goes_on_as_if_it_had_not_been_saved(tmp_path):
    whole = summary_of(tmp_path, "--robots", 2, "--duration", 2)
    summary_of(tmp_path, "--robots", 2, "--duration", 0.7, "--save-state", tmp_path / "state.json")
    rest = summary_of(tmp_path, "--load-state", tmp_path / "state.json", "--duration", 1.3)
    assert rest["sim_time"] == pytest.approx(2.0)
    assert rest["state_sha256"] == whole["state_sha256"]
    assert rest["real_time_factor"] == pytest.approx(1.3 / rest["wall_time"])  # of what this process has simulated


def test_a_recorded_run_is_replayed(tmp_path):
    done = summary_of(tmp_path, "--robots", 1, "--duration", 1, "--record", tmp_path / "run.json")
    again = summary_of(tmp_path, "--replay", tmp_path / "run.json", "--duration", 0.001)
    assert again["sim_time"] == pytest.approx(1.001)
    assert again["steps"] == done["steps"] + 1


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--load-state", "gone.json"], "cannot read a saved state"),
        (["--replay", "gone.json"], "cannot read a recording"),
        (["--load-state", "a.json", "--replay", "b.json"], "cannot be combined"),
        (["--load-state", "a.json", "--robots", "2"], "cannot be combined with a target"),
        (["--load-state", "a.json", "--engine", "cenic"], "continues as it was saved"),
        (["--replay", "a.json", "--pub", "/a", "[1]"], "cannot be combined with"),
        (["--robots", "1", "--save-state", "/nowhere/state.json"], "no file can be written there"),
    ],
)
def test_saved_states_that_cannot_be_are_refused(capsys, options, reason):
    assert reason in refused(capsys, *options)


def test_a_replay_says_when_the_recording_ends(tmp_path, capsys):
    summary_of(tmp_path, "--robots", 1, "--duration", 0.5, "--record", tmp_path / "run.json")
    capsys.readouterr()
    summary_of(tmp_path, "--replay", tmp_path / "run.json", "--duration", 0.1)
    assert capsys.readouterr().err == "replay: the recording ends at 0.500 s: the run continues from there\n"


def test_a_replay_can_end_with_the_recording(tmp_path, capsys):
    done = summary_of(tmp_path, "--robots", 1, "--duration", 0.5, "--record", tmp_path / "run.json")
    capsys.readouterr()
    file = tmp_path / "again.json"
    assert main(["--replay", str(tmp_path / "run.json"), "--end-with-recording", "--summary", str(file)]) == 0
    captured = capsys.readouterr()
    assert captured.err == "replay: the recording ends at 0.500 s: the run ends with it\n"
    assert "page: " not in captured.out
    assert json.loads(file.read_text())["state_sha256"] == done["state_sha256"]


def test_only_a_replay_ends_with_its_recording(capsys):
    assert "--end-with-recording ends the run where its recording ends: it needs --replay FILE" in refused(
        capsys, "--end-with-recording"
    )
    assert main(["--replay", "a.json", "--end-with-recording", "--duration", "1"]) == 2
    assert "it cannot be combined with --duration" in capsys.readouterr().err
