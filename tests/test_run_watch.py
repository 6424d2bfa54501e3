"""``drake_twin.run --watch``, with the edits made where the loop looks for them."""

import shutil
from pathlib import Path

import pytest
from program_runs import LAUNCH_ARM, summary_of

from drake_twin.cli.watched_files import Watch

LINK = '<link name="world"/>'
GOOD, BETTER, BROKEN = f'<robot name="good">{LINK}</robot>', f'<robot name="better">{LINK}</robot>', "<robot"


@pytest.fixture
def watching(tmp_path, monkeypatch):
    """Runs a launch file with --watch; at each look of the loop the robot file becomes the next text."""
    robot, launch = tmp_path / "r.urdf", tmp_path / "r.launch.xml"
    robot.write_text(GOOD)
    launch.write_text(
        '<launch><node pkg="robot_state_publisher" exec="robot_state_publisher">'
        f'<param name="robot_description" value="$(command \'cat {robot}\')"/></node>'
        f'<node pkg="ros_gz_sim" exec="create" args="-file {robot}"/></launch>'
    )
    edits: list[tuple[Path, str]] = []

    class EditedWatch(Watch):
        def poll(self):
            if edits:
                file, text = edits.pop(0)
                file.write_text(text)
            self.changed_file = self.next_change()
            return self.has_changed

    monkeypatch.setattr("drake_twin.run.Watch", EditedWatch)

    def watched(*texts, arguments=()):
        edits[:] = [item if isinstance(item, tuple) else (robot, item) for item in texts]
        return summary_of(tmp_path, launch, "--watch", "--duration", 0.2, *arguments)

    watched.launch = launch
    return watched


def test_a_changed_file_rebuilds_the_twin(watching, capsys):
    result = watching(BETTER)
    assert list(result["robots"]) == ["better"]
    assert result["sim_time"] == pytest.approx(0.2)
    assert f"changed: {watching.launch.parent / 'r.urdf'}\n" in capsys.readouterr().err


@pytest.mark.parametrize("broken", [BROKEN, "", '<robot name="r"><link name="a"/><link name="a"/></robot>'])
def test_a_broken_edit_keeps_the_last_good_twin(watching, capsys, broken):
    assert list(watching(BETTER, broken)["robots"]) == ["better"]
    error = capsys.readouterr().err
    assert error.count("changed: ") == 2
    assert "\nerror: " in error
    assert error.endswith("The last good twin continues.\n")
    assert "Traceback" not in error


def test_an_edit_after_a_broken_one_is_taken(watching):
    assert list(watching(BROKEN, BETTER)["robots"]) == ["better"]


def test_a_broken_launch_file_keeps_the_last_good_twin_and_is_still_watched(watching, capsys):
    good = watching.launch.read_text()
    result = watching((watching.launch, "<launch><fly/></launch>"), (watching.launch, good + "\n"), BETTER)
    assert list(result["robots"]) == ["better"]
    assert f"error: {watching.launch}:1: " in capsys.readouterr().err


def test_an_edit_that_strict_refuses_keeps_the_last_good_twin(watching, capsys):
    more = watching.launch.read_text().replace("</launch>", '<node pkg="foo" exec="bar"/></launch>')
    assert list(watching((watching.launch, more), arguments=["--strict"])["robots"]) == ["good"]
    assert "error: --strict: 1 not started, see above" in capsys.readouterr().err


def test_a_new_twin_echoes_the_topic_again(watching, capsys):
    watching(BETTER, arguments=["--echo", "/robot_description"])
    assert 'data: <robot name="better">' in capsys.readouterr().out


def test_a_new_twin_keeps_the_time_control_and_watches_what_was_not_read_again(tmp_path):
    from drake_twin.cli import options as run_options
    from drake_twin.cli.rebuilt_twin import rebuilt_twin
    from drake_twin.cli.target import build_twin, find_target

    own = shutil.copytree(LAUNCH_ARM.parents[2], tmp_path / "models")  # what is installed is not watched
    launch_file = own / LAUNCH_ARM.relative_to(LAUNCH_ARM.parents[2])
    options = run_options.parser().parse_args([str(launch_file), "--headless"])
    mesh = tmp_path / "read_once_and_cached.stl"
    target = find_target(options)
    twin = build_twin(target)
    twin.clock.paused, twin.clock.real_time_rate = True, 3.0
    new_twin, _, watch = rebuilt_twin(twin, target, options, Watch({mesh: None}))
    assert new_twin is not twin
    assert (new_twin.clock.paused, new_twin.clock.real_time_rate) == (True, 3.0)
    assert {mesh, launch_file} <= set(watch.files)


def test_a_recording_under_watch_is_of_the_twin_that_runs_at_the_end(watching, tmp_path):
    watching(BETTER, arguments=["--record", tmp_path / "run.json"])
    again = summary_of(tmp_path, "--replay", tmp_path / "run.json", "--duration", 0.1)
    assert list(again["robots"]) == ["better"]
