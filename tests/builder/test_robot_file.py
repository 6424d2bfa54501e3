import numpy as np
import pytest

from drake_twin import Twin
from drake_twin.builder.robot_file import planned_robots
from drake_twin.description.package_index import share_folder
from drake_twin.errors import InputError

MODELS = share_folder("models")
ROVER = MODELS / "rover_description" / "urdf" / "rover.urdf.xacro"
ARM = MODELS / "arduinobot_description" / "urdf" / "arduinobot.urdf.xacro"

PREFIXED = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="{argument}" default=""/>
  <link name="$(arg {argument})base">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.25"/></geometry></collision>
  </link>
</robot>"""


def test_a_single_robot_keeps_the_name_its_file_gives_it():
    (robot,) = planned_robots(ARM, xacro_args={}).scenario.robots
    assert robot.name == "arduinobot"


def test_a_mobile_robot_stands_on_the_ground_and_stays_there():
    scenario = planned_robots(ROVER, xacro_args={}).scenario
    assert scenario.robots[0].xyz[2] == pytest.approx(0.13, abs=0.001)
    twin = Twin(scenario)
    twin.advance_to(1.0)
    assert twin.robot_state("rover").base_pose[2] == pytest.approx(scenario.robots[0].xyz[2], abs=0.001)


def test_a_robot_bolted_to_the_world_stays_at_the_origin():
    assert planned_robots(ARM, xacro_args={}).scenario.robots[0].xyz == (0, 0, 0)


def test_several_robots_stand_in_a_row_that_leaves_each_room_to_turn():
    scenario = planned_robots(ROVER, 3, xacro_args={}).scenario
    assert [robot.name for robot in scenario.robots] == ["robot_1", "robot_2", "robot_3"]
    gaps = np.diff([robot.xyz[1] for robot in scenario.robots])
    assert np.all(gaps > np.hypot(0.58, 0.47))


@pytest.mark.parametrize(
    ("size", "spacing"), [((3.0, 0.2, 0.1), 6.0), ((0.2, 1.2, 0.1), 2.4), ((0.2, 0.1, 2.0), 0.5), ((0.1, 0.33, 9), 0.7)]
)
def test_the_row_leaves_twice_the_larger_side_of_the_robot_and_half_a_meter_at_least(tmp_path, size, spacing):
    box = f"<collision><geometry><box size='{' '.join(map(str, size))}'/></geometry></collision>"
    text = PREFIXED.format(argument="n").replace("<collision>", f"{box}<collision>").replace("0.25", "0.01")
    (tmp_path / "r.urdf.xacro").write_text(text)
    robots = planned_robots(tmp_path / "r.urdf.xacro", 3, xacro_args={}).scenario.robots
    assert [robot.xyz[1] for robot in robots] == pytest.approx([0.0, spacing, 2 * spacing])


@pytest.mark.parametrize(
    ("argument", "value"), [("robot_name", "robot_2"), ("prefix", "robot_2_"), ("namespace", "robot_2")]
)
def test_several_robots_are_named_through_the_files_own_argument(tmp_path, argument, value):
    file = tmp_path / "r.urdf.xacro"
    file.write_text(PREFIXED.format(argument=argument))
    robots = planned_robots(file, 2, xacro_args={}).scenario.robots
    assert robots[1].xacro_args == {argument: value}


def test_a_robot_file_alone_keeps_its_own_default_of_robot_name(tmp_path):
    """A lesson's file has links whose names begin with the default."""
    file = tmp_path / "r.urdf.xacro"
    text = PREFIXED.format(argument="robot_name").replace('default=""', 'default="lesson_"')
    joint = '<joint name="j" type="fixed"><parent link="lesson_base"/><child link="arm"/></joint></robot>'
    file.write_text(text.replace("</robot>", f'<link name="arm"/>{joint}'))
    scenario = planned_robots(file, xacro_args={}).scenario
    assert scenario.robots[0].name == "r"
    assert Twin(scenario).built.plans[0].description.links == ("lesson_base", "arm")
    assert planned_robots(file, 2, xacro_args={"robot_name": "lesson_"}).scenario.robots[0].name == "robot_1"
    file.write_text(text.replace('default="lesson_"', 'default="$(arg other)"'))
    (robot,) = planned_robots(file, xacro_args={"other": "x"}).scenario.robots
    assert "robot_name" not in robot.xacro_args


def test_an_argument_typed_by_the_user_is_left_alone(tmp_path):
    file = tmp_path / "r.urdf.xacro"
    file.write_text(PREFIXED.format(argument="prefix"))
    assert planned_robots(file, 2, xacro_args={"prefix": "x_"}).scenario.robots[0].xacro_args == {"prefix": "x_"}


def test_robots_without_such_an_argument_are_prefixed_by_the_twin():
    twin = Twin(planned_robots(ARM, 2, xacro_args={}).scenario)
    frames = {item.child_frame_id for item in twin.latest("/tf").transforms}
    assert {"robot_1/forearm", "robot_2/forearm"} <= frames


def test_a_file_that_is_no_robot_is_refused(tmp_path):
    file = tmp_path / "notes.txt"
    file.write_text("nothing here")
    with pytest.raises(InputError, match=r"notes\.txt: this is not a robot file, which is a xacro or URDF"):
        planned_robots(file, xacro_args={})
