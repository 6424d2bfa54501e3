"""Twenty-one programs beside what the real rclpy printed; see rclpy_outcomes/README.md."""

import subprocess

import pytest
from outcome_runs import (
    FOLDER,
    PROGRAMS,
    compared,
    judged,
    prepared,
    recorded,
    run_in_twin,
    run_with_ros,
)

from drake_twin.wires.rclpy_process import find_rclpy


def listed(name):
    """The lines of a program that differ for a reason that ``differing.txt`` gives."""
    found, program = [], ""
    for line in (FOLDER / "differing.txt").read_text("utf-8").split("\n"):
        if line.startswith("== "):
            program = line.removeprefix("== ")
        elif line[:2] in ("- ", "+ ") and program == name:
            found.append(line)
    return found


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_program_prints_what_the_real_rclpy_printed(name, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run_in_twin(prepared(name, tmp_path))
    assert sorted(compared(name, judged(capsys.readouterr().out.split("\n")))) == sorted(listed(name))


def test_at_most_two_percent_of_the_lines_differ():
    lines = sum(len(recorded(name)) for name in PROGRAMS)
    assert lines == 4813
    assert sum(line[0] == "-" for name in PROGRAMS for line in listed(name)) <= 0.02 * lines


@pytest.mark.ros
@pytest.mark.parametrize("name", [name for name in PROGRAMS if name != "p40_testmsgs"])
def test_the_real_rclpy_still_prints_it(name, tmp_path):
    """A newer one may differ: then the recording is to be made anew, and the stand-in follows it."""
    rclpy = find_rclpy()
    python = next(each for each in rclpy.interpreters() if not subprocess.call([each, "-c", "import rclpy"]))
    found = compared(name, run_with_ros(prepared(name, tmp_path), python))
    assert len(found) <= 0.1 * len(recorded(name)) + 2, found
