"""A process's own folder is there while it runs, and gone afterwards, however it has ended."""

import subprocess
import sys

import pytest

HOLDS = "from drake_twin.scratch_folder import scratch_folder; print(scratch_folder(), flush=True); "


@pytest.fixture
def folders(tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    return lambda: [str(folder) for folder in tmp_path.iterdir()]


def holder(more="input()"):
    """A process with a folder of its own; the folder."""
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    process = subprocess.Popen([sys.executable, "-c", HOLDS + more], **pipes)
    return process, process.stdout.readline().strip()


def test_a_process_that_ends_removes_its_folder(folders):
    process, folder = holder()
    assert folders() == [folder]
    process.communicate("\n")
    assert folders() == []


def test_the_next_process_removes_what_a_killed_one_has_left(folders):
    living, kept = holder()
    killed, left = holder()
    killed.kill()
    killed.communicate()
    assert sorted(folders()) == sorted([kept, left])
    another, new = holder()
    assert sorted(folders()) == sorted([kept, new])
    for process in (living, another):
        process.communicate("\n")
    assert folders() == []


def test_what_is_not_a_folder_of_this_user_is_left_alone(folders, tmp_path):
    (tmp_path / "mine").mkdir()
    link = tmp_path / "drake_twin_process_link"
    link.symlink_to(tmp_path / "mine")
    process, folder = holder()
    assert sorted(folders()) == sorted([folder, str(link), str(tmp_path / "mine")])
    process.communicate("\n")
