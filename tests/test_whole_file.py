"""A file is whole or as it was before, also where it cannot be replaced."""

import os

import pytest

from drake_twin import whole_file
from drake_twin.errors import RunError
from drake_twin.whole_file import write_result, write_whole


@pytest.fixture
def in_place(monkeypatch):
    """Files that exist are written in place, as in a folder that this user cannot write."""
    monkeypatch.setattr(os, "access", lambda path, mode: False)


@pytest.mark.parametrize("content", ["", "short", "longer than before"])
def test_a_file_in_a_closed_folder_is_written_in_place(tmp_path, in_place, content):
    file = tmp_path / "file"
    file.write_text("before")
    write_whole(file, content)
    assert file.read_text() == content


def test_a_full_disk_leaves_a_file_in_a_closed_folder_as_it_was(tmp_path, in_place, monkeypatch):
    def full(descriptor, offset, length):
        os.truncate(descriptor, offset + length)  # a part of it, as file systems may
        raise OSError(28, "No space left on device")

    file = tmp_path / "file"
    file.write_text("before")
    monkeypatch.setattr(whole_file.os, "posix_fallocate", full)
    with pytest.raises(RunError, match=r"^the page .* cannot be written \(No space left on device\): nothing is lost$"):
        write_result("page", file, "a longer content", ": nothing is lost")
    assert file.read_text() == "before"


@pytest.mark.parametrize("name", ["/dev/full", "/proc/x", "no/folder"])
def test_a_place_that_cannot_be_written_is_an_error_that_names_it(tmp_path, name):
    with pytest.raises(RunError, match=r"the page .* cannot be written"):
        write_result("page", tmp_path / name, "content")
