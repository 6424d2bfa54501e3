import contextlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from drake_twin.cli.options import parser
from drake_twin.cli.target import find_target
from drake_twin.cli.watched_files import Watch, files_read
from drake_twin.description.mesh_cache import cache_folder
from drake_twin.description.package_index import share_folder


def read(file: Path) -> dict:
    with files_read() as files:
        file.read_text()
    return files


@pytest.fixture
def models(tmp_path) -> Path:
    """A person's copy of the twin's own models: what is installed beside Python's packages is not watched."""
    return Path(shutil.copytree(share_folder("models"), tmp_path / "models"))


@pytest.fixture
def file(tmp_path) -> Path:
    (tmp_path / "a.xacro").write_text("a")
    return tmp_path / "a.xacro"


def test_every_file_that_a_launch_file_is_made_of_is_watched(models):
    options = parser().parse_args([str(models / "rover_gazebo" / "launch" / "main.launch.xml")])
    with files_read() as files:
        find_target(options)
    names = {str(file.relative_to(models)) for file in files if file.is_relative_to(models)}
    launch = {
        str(file.relative_to(models)) for file in (models / "rover_gazebo" / "launch").iterdir() if file.is_file()
    }
    assert names >= launch | {
        "rover_gazebo/worlds/plain.sdf",
        "rover_description/config/rover_controllers.yaml",
        "rover_description/urdf/rover.urdf.xacro",
        "rover_description/urdf/wheel.xacro",
    }


def test_meshes_are_watched_and_the_cache_is_not(models):
    program = (
        "import sys; from drake_twin.cli.options import parser\n"
        "from drake_twin.cli.target import build_twin, find_target\n"
        "from drake_twin.cli.watched_files import files_read\n"
        "with files_read() as files: build_twin(find_target(parser().parse_args(sys.argv[1:])))\n"
        "print(*files, sep='\\n')"
    )
    command = [sys.executable, "-c", program, str(models / "arduinobot_description/launch/gazebo.launch.py")]
    output = subprocess.run(command, capture_output=True, text=True, check=True, cwd=models.parent).stdout
    files = [Path(line) for line in output.splitlines()]
    assert models / "arduinobot_description" / "meshes" / "claw.stl" in files
    assert not [file for file in files if file.is_relative_to(cache_folder("launch").parent)]
    assert not [file for file in files if "site-packages" in file.parts]


def test_only_files_that_describe_a_twin_and_that_are_read_are_watched(tmp_path):
    with files_read() as files:
        (tmp_path / "written.yaml").write_text("x")
        (tmp_path / "notes.txt").write_text("x")
        (tmp_path / "notes.txt").read_text()
        (tmp_path / "written.yaml").with_suffix(".yml").exists()
    assert not files
    (tmp_path / "written.yaml").read_text()
    assert not files  # after the end


def test_a_launch_folder_below_one_of_the_twins_own_name_is_watched(tmp_path):
    file = tmp_path / "drake_twin" / "launch" / "my.launch.py"
    file.parent.mkdir(parents=True)
    file.write_text("x")
    assert list(read(file)) == [file]


def test_a_file_that_fails_to_be_read_is_watched(file):
    file.write_bytes(b"\xff")
    with contextlib.suppress(UnicodeDecodeError), files_read() as files:
        file.read_text(encoding="utf-8")
    assert list(files) == [file]


def test_a_change_is_told_once(file):
    watch = Watch(read(file))
    assert watch.next_change() is None
    file.write_text("longer")
    assert (watch.next_change(), watch.next_change()) == (file, None)


def test_a_change_between_reading_and_watching_is_told(file):
    files = read(file)
    file.write_text("edited while the twin is built")
    assert Watch(files).next_change() == file


def test_a_change_of_the_same_length_and_a_file_that_goes_and_comes_are_told(file):
    watch = Watch(read(file))
    os.utime(file, ns=(1, 1))
    assert watch.next_change() == file
    file.unlink()
    assert watch.next_change() == file
    assert watch.next_change() is None
    file.write_text("again")
    assert watch.next_change() == file


def test_breaking_off_names_the_file(file):
    watch = Watch(read(file))
    assert not watch.poll()
    watch = Watch(watch.files)
    file.write_text("longer")
    assert watch.poll()
    assert (watch.has_changed, watch.changed_file) == (True, file)
