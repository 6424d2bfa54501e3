"""Robots that stand in a world's file, and robots that are spawned under the name of a model of the world."""

from pathlib import Path

import pytest
from launch_files import not_started, write, write_package

from drake_twin import Twin
from drake_twin.builder.launch_file import launch_file_scenario
from drake_twin.errors import InputError
from drake_twin.findings import Kind

BASE = """<model name="{name}">{pose}<link name="base_link"><inertial><mass>1</mass></inertial>
<collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link>{plugin}</model>"""
DRIVE = """<plugin filename="gz-sim-velocity-control-system" name="gz::sim::systems::VelocityControl">
<topic>/cmd_vel</topic></plugin>"""
CREATE = '<node pkg="ros_gz_sim" exec="create" args="-name {name} -file $(dirname)/spawned.sdf -z 0.1 -x 3"/>'
POSE = "<pose>1 2 0.1 0 0 0.5</pose>"


def launched(folder, models, nodes=""):
    world = f'<sdf version="1.9"><world name="w">{models}</world></sdf>'
    (folder / "room.sdf").write_text(world)
    (folder / "spawned.sdf").write_text(
        f'<sdf version="1.9">{BASE.format(name="spawned", pose="", plugin=DRIVE)}</sdf>'
    )
    start = '<executable cmd="gz sim -r $(dirname)/room.sdf"/>'
    (folder / "room.launch.xml").write_text(f"<launch>{start}{nodes}</launch>")
    return launch_file_scenario(folder / "room.launch.xml")


GROUND = """<model name="ground"><static>true</static><link name="l"><collision name="c"><geometry><plane>
<normal>0 0 1</normal></plane></geometry></collision></link></model>"""


def test_a_model_with_a_drive_is_a_robot(tmp_path):
    box = BASE.format(name="ball", pose="<pose>5 0 0.1 0 0 0</pose>", plugin="")
    models = GROUND + BASE.format(name="rover", pose=POSE, plugin=DRIVE) + box
    scenario = launched(tmp_path, models).scenario
    (robot,) = scenario.robots
    assert (robot.name, robot.xyz, robot.topic_namespace) == ("rover", (1.0, 2.0, 0.1), "")
    assert robot.rpy == pytest.approx((0.0, 0.0, 0.5))
    assert scenario.world.without_models == ("rover",)
    twin = Twin(scenario)
    assert twin.entities.state("ball").position[0] == pytest.approx(5.0)
    twin.publish("/cmd_vel", {"linear": {"x": 0.5}})
    twin.advance_to(1.0)
    x, y, *_ = twin.robot_state("rover").base_pose
    assert (x - 1.0, y - 2.0) == pytest.approx((0.5 * 0.8776, 0.5 * 0.4794), abs=0.02)


BELT = """<static>1</static><plugin filename="gz-sim-track-controller-system" name="gz::sim::systems::TrackController">
<link>base_link</link></plugin>"""
PUBLISHER = """<node pkg="robot_state_publisher" exec="robot_state_publisher">
<param name="frame_prefix" value="shown/"/>
<param name="robot_description" value="&lt;robot name='shown'&gt;&lt;link name='top'/&gt;&lt;/robot&gt;"/></node>"""


def test_a_belt_of_the_world_is_a_robot_beside_those_of_the_launch_file(tmp_path):
    models = GROUND + BASE.format(name="conveyor", pose=POSE, plugin=BELT)
    scenario = launched(tmp_path, models, CREATE.format(name="rover") + PUBLISHER).scenario
    assert {robot.name: robot.frame_prefix for robot in scenario.robots} == {"conveyor": "", "rover": "shown/"}
    assert scenario.world.without_models == ("conveyor",)


def test_a_robot_that_is_only_displayed_stays_beside_a_belt_of_the_world(tmp_path):
    models = GROUND + BASE.format(name="conveyor", pose=POSE, plugin=BELT)
    launch = launched(tmp_path, models, PUBLISHER)
    assert sorted(robot.name for robot in launch.scenario.robots) == ["conveyor", "shown"]


def test_a_world_of_someone_elses_machine_is_found_in_the_package_its_folders_are_named_after(tmp_path):
    share = write_package(tmp_path, "rooms")
    room = write(share / "worlds" / "room.sdf", f'<sdf version="1.9"><world name="w">{GROUND}</world></sdf>')
    write(share / "spawned.sdf", f'<sdf version="1.9">{BASE.format(name="spawned", pose="", plugin=DRIVE)}</sdf>')
    start = '<executable cmd="gz sim -r /home/someone/ws/src/rooms/worlds/room.sdf"/>'
    launch = write(share / "room.launch.xml", f"<launch>{start}{CREATE.format(name='rover')}</launch>")
    scenario = launch_file_scenario(launch).scenario
    assert Path(scenario.world.file).read_text() == room.read_text()
    (what,) = [item.what for item in scenario.findings if item.kind is Kind.WARNING]
    assert what.startswith("world /home/someone/ws/src/rooms/worlds/room.sdf is not on this machine: ")


def test_a_robot_under_the_name_of_a_model_of_the_world_is_refused_as_in_gazebo(tmp_path):
    models = GROUND + BASE.format(name="rover", pose=POSE, plugin=DRIVE)
    scenario = launched(tmp_path, models, CREATE.format(name="rover")).scenario
    (robot,) = scenario.robots
    assert robot.xyz == (1.0, 2.0, 0.1)
    (reason,) = not_started(scenario)
    assert "the world has a model named 'rover' already" in reason


def test_without_another_robot_the_reason_is_in_the_error(tmp_path):
    models = GROUND + BASE.format(name="rover", pose=POSE, plugin="")
    with pytest.raises(InputError, match=r"starts no robot.* the world has a model named 'rover' already"):
        launched(tmp_path, models, CREATE.format(name="rover"))


def test_lines_of_findings_are_those_of_the_world_file(tmp_path):
    plugin = DRIVE.replace("<topic>", "\n<bogus>1</bogus>\n<topic>")
    scenario = launched(tmp_path, GROUND + BASE.format(name="rover", pose="", plugin=plugin)).scenario
    text = (tmp_path / "room.sdf").read_text().splitlines()
    line = next(index for index, each in enumerate(text, start=1) if "<plugin" in each)
    (finding,) = [item for item in Twin(scenario).findings if "bogus" in item.what]
    assert str(finding).endswith(f"(room.sdf:{line})")
