"""The twin of changed files has the recorder, the pause and the rate of the one before."""

import os

import pytest

from drake_twin.cli.options import parser
from drake_twin.cli.rebuilt_twin import rebuilt_twin
from drake_twin.cli.target import build_twin, find_target
from drake_twin.cli.watched_files import Watch, files_read

ROBOT = '<robot name="{}"><link name="world"/></robot>'


@pytest.fixture
def file(tmp_path):
    found = tmp_path / "r.urdf"
    found.write_text(ROBOT.format("good"))
    return found


@pytest.fixture
def before(file):
    """A twin of the file, its target, its options and its watch."""
    options = parser().parse_args([str(file)])
    with files_read() as files:
        target = find_target(options)
        twin = build_twin(target)
    return twin, target, options, Watch(files)


def edit(file, watch, text):
    file.write_text(text)
    os.utime(file, ns=(1, 1))
    watch.changed_file = watch.next_change()
    assert watch.changed_file == file


@pytest.mark.parametrize(("records", "paused", "rate"), [(True, True, 0.5), (False, False, 2.0)])
def test_what_the_user_has_set_stays(before, file, capsys, records, paused, rate):
    twin, target, options, watch = before
    if records:
        twin.recorder.begin()
    twin.clock.paused, twin.clock.real_time_rate = paused, rate
    edit(file, watch, ROBOT.format("better"))
    new, new_target, new_watch = rebuilt_twin(twin, target, options, watch)
    assert new is not twin
    assert [robot.name for robot in new_target.scenario.robots] == list(new.robots) == ["better"]
    assert (new.recorder.is_on, new.clock.paused, new.clock.real_time_rate) == (records, paused, rate)
    assert file in new_watch.files
    assert not new_watch.poll()
    assert f"changed: {file}\n" in capsys.readouterr().err


def test_after_a_broken_edit_the_twin_stays_and_its_file_is_watched(before, file, capsys):
    twin, target, options, watch = before
    edit(file, watch, "<robot")
    new, new_target, new_watch = rebuilt_twin(twin, target, options, watch)
    assert (new, new_target) == (twin, target)
    assert capsys.readouterr().err.endswith("The last good twin continues.\n")
    edit(file, new_watch, ROBOT.format("better"))
    assert list(rebuilt_twin(new, new_target, options, new_watch)[0].robots) == ["better"]
