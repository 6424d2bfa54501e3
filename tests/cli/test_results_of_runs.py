"""What is kept of a run: each file whole, and the first error of several."""

import json

import pytest
from conftest import rovers

from drake_twin.cli.options import parser
from drake_twin.cli.results import save_results
from drake_twin.errors import RunError
from drake_twin.program import NO_MEMORY
from drake_twin.twin.recording import Recording
from drake_twin.twin.snapshot import Snapshot
from drake_twin.whole_file import write_result


@pytest.fixture(scope="module")
def twin():
    with rovers(1).build() as twin:
        twin.recorder.begin()
        twin.advance_to(0.1)
        yield twin


def options(folder):
    files = [f"--{name}={folder / name}.json" for name in ("save-state", "record", "summary")]
    return parser().parse_args(files)


def test_the_files_that_are_asked_for_are_written(twin, tmp_path, capsys):
    assert save_results(twin, 0.1, 0.4, options(tmp_path), None) is None
    assert Snapshot.load(tmp_path / "save-state.json") == twin.snapshot()
    assert Recording.load(tmp_path / "record.json").end == twin.time
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert (summary["wall_time"], summary["real_time_factor"]) == (0.4, pytest.approx(0.25))
    assert capsys.readouterr().out == (
        f"1 robot, 0.100 s simulated in 0.400 s (real-time factor 0.25), state {twin.state_sha256()[:12]}\n"
    )


def test_without_options_the_result_is_printed(twin, tmp_path, capsys):
    assert save_results(twin, 0.05, 0.1, parser().parse_args([]), None) is None
    assert "0.050 s simulated in 0.100 s (real-time factor 0.50), at 0.100 s, state " in capsys.readouterr().out


def test_a_file_that_fails_does_not_prevent_the_others(twin, tmp_path, capsys):
    (tmp_path / "save-state.json").mkdir()
    found = save_results(twin, 0.1, 0.4, options(tmp_path), None)
    assert "save-state.json (Is a directory)" in str(found)
    assert (tmp_path / "record.json").is_file()
    assert (tmp_path / "summary.json").is_file()
    assert capsys.readouterr().err == ""


def test_the_error_of_the_run_comes_first_and_that_of_a_file_is_printed(twin, tmp_path, capsys):
    (tmp_path / "record.json").mkdir()
    failure = RunError("it fell")
    assert save_results(twin, 0.1, 0.4, options(tmp_path), failure) is failure
    assert json.loads((tmp_path / "summary.json").read_text())["failure"] == "it fell"
    assert "record.json (Is a directory)" in capsys.readouterr().err


def test_a_result_that_cannot_be_written_is_named(tmp_path):
    write_result("table", tmp_path / "a.csv", "x\n")
    assert (tmp_path / "a.csv").read_text() == "x\n"
    (tmp_path / "b.csv").mkdir()
    with pytest.raises(RunError, match=r"the table .*b.csv cannot be written \(Is a directory\)"):
        write_result("table", tmp_path / "b.csv", "x\n")


def test_a_file_for_which_there_is_no_memory_does_not_prevent_the_others(twin, tmp_path, monkeypatch):
    monkeypatch.setattr(Snapshot, "save", lambda self, file: bytearray(1 << 60))
    assert str(save_results(twin, 0.1, 0.4, options(tmp_path), None)) == NO_MEMORY
    assert (tmp_path / "record.json").is_file()
    assert (tmp_path / "summary.json").is_file()
