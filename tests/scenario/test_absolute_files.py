"""A twin whose files were given relative to a working directory, used from another one."""

import pytest
from launch_files import write
from program_runs import run

from drake_twin import Finding, Kind, Recording, Robot, Scenario, Snapshot, Twin, World, replay
from drake_twin.scenario import NodeProgram
from drake_twin.scenario.absolute_files import with_files_found

LINK = '<link name="l"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
BOX = '<link name="l"><collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link>'
WORLD = f'<sdf version="1.9"><world name="w"><model name="box"><pose>0 3 1 0 0 0</pose>{BOX}</model></world></sdf>'
NONE = "controller_manager: {ros__parameters: {update_rate: 100}}"


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A working directory with files, beside another one."""
    for file, text in {
        "robots/r.urdf": f'<robot name="r">{LINK}</link></robot>',
        "robots/beside.yaml": NONE,
        "beside.yaml": "refused: 1",
        "own.yaml": NONE,
        "w.sdf": WORLD,
        "resources/far.sdf": WORLD,
    }.items():
        write(tmp_path / "here" / file, text)
    (tmp_path / "there").mkdir()
    monkeypatch.setenv("GZ_SIM_RESOURCE_PATH", str(tmp_path / "here" / "resources"))
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path / "here"


def scenario(world="w.sdf", controllers=()):
    return Scenario(
        (Robot("r", "robots/r.urdf", controllers=controllers),), world=World(file=world), package_paths=(".",)
    )


@pytest.mark.parametrize("world", ["w.sdf", "far.sdf", "empty.sdf"])
def test_a_snapshot_and_a_recording_mean_the_same_in_another_folder(here, monkeypatch, world):
    twin = Twin(scenario(world))
    twin.recorder.begin()
    twin.step(5)
    saved, then = twin.snapshot(), twin.state_sha256()
    saved.save(here / "state.json")
    twin.entities.spawn(Robot("s", "robots/r.urdf", xyz=(3, 0, 0)))
    monkeypatch.chdir(here.parent / "there")
    twin.step(5)
    twin.recorder.recording().save(here / "run.json")
    assert replay(Recording.load(here / "run.json")).state_sha256() == twin.state_sha256()
    twin.restore(saved)
    assert twin.state_sha256() == then
    twin.entities.delete("ground_plane" if world == "empty.sdf" else "box")  # which reads the world again
    twin.restore(Snapshot.load(here / "state.json"))
    assert twin.state_sha256() == then


@pytest.mark.one_plant  # the program that continues is one of its own
def test_the_program_continues_in_another_folder(here):
    twin = Twin(scenario())
    twin.snapshot().save(here / "state.json")
    result = run("--load-state", here / "state.json", "--headless", "--duration", 0.01, cwd=here.parent / "there")
    assert (result.returncode, result.stdout[:7]) == (0, "1 robot")


def test_a_controllers_file_is_the_one_that_the_twin_reads(here):
    found = with_files_found(scenario(controllers=("beside.yaml", "own.yaml")))
    assert found.robots[0].controllers == (str(here / "robots" / "beside.yaml"), str(here / "own.yaml"))
    assert found.robots[0].model == str(here / "robots" / "r.urdf")
    assert (found.world.file, found.package_paths) == (str(here / "w.sdf"), (str(here),))


def test_a_scenario_of_absolute_names_is_itself_and_what_is_missing_keeps_its_name(here):
    found = with_files_found(scenario())
    assert with_files_found(found) is found
    nodes = (NodeProgram("script.py"), NodeProgram("program", package="p"))
    other = Scenario(
        (Robot("r", "package://p/r.urdf", controllers=("no.yaml",)),), world=World(file="no.sdf"), nodes=nodes
    )
    found = with_files_found(other)
    assert (found.robots, found.world) == (other.robots, other.world)
    assert [node.executable for node in found.nodes] == [str(here / "script.py"), "program"]


def test_a_recorded_reset_to_a_scenario_with_findings_is_read_again(here):
    twin = Twin(scenario())
    twin.recorder.begin()
    twin.reset(Scenario((Robot("r", "robots/r.urdf"),), findings=(Finding(Kind.IGNORED, "a part"),)))
    twin.recorder.recording().save(here / "run.json")
    again = replay(Recording.load(here / "run.json"))
    assert again.scenario == twin.scenario
    assert again.state_sha256() == twin.state_sha256()
