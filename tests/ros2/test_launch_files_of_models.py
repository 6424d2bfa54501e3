"""The launch files in models/: valid for a ROS 2 workspace, and evaluated here."""

from pathlib import Path

import pytest
from lxml import etree
from urdf_text import parse_urdf

from drake_twin.description.package_index import share_folder
from drake_twin.ros2.evaluate import declared_arguments, evaluate

MODELS = share_folder("models")
MAIN = MODELS / "rover_gazebo" / "launch" / "main.launch.xml"
ARM = MODELS / "arduinobot_description" / "launch" / "gazebo.launch.py"
LAUNCH_FILES = sorted(MODELS.glob("*/launch/*.launch.*"))


def of(launched, what):
    return [process for process in launched.processes if process.what == what]


def test_all_launch_files_are_here():
    assert len(LAUNCH_FILES) == 13


@pytest.mark.parametrize("file", LAUNCH_FILES, ids=lambda file: file.name)
def test_every_launch_file_is_evaluated_without_a_complaint(file):
    launched = evaluate(file)
    assert launched.processes
    assert (launched.failed_includes, launched.absent_packages, launched.unfired_handlers, launched.log) == ((),) * 4


@pytest.mark.parametrize("file", LAUNCH_FILES, ids=lambda file: file.name)
def test_packages_declare_what_their_launch_files_start(file):
    package = file.parents[1]
    declared = {item.text for item in etree.parse(package / "package.xml").iter("exec_depend")} | {package.name}
    started = {process.package for process in evaluate(file).processes}
    assert started <= declared
    assert "launch" in (package / "CMakeLists.txt").read_text()


def test_two_rovers_start_one_after_the_other_in_one_world():
    launched = evaluate(MAIN)
    (world,) = (process.world for process in launched.processes if process.kind == "world")
    assert (Path(world.world).name, world.paused) == ("plain.sdf", False)
    publishers = of(launched, "robot_state_publisher/robot_state_publisher")
    assert [item.resolve("robot_description") for item in publishers] == [
        "/robot_1_robot_description",
        "/robot_2_robot_description",
    ]
    assert publishers[1].resolve("joint_states") == "/robot_2/joint_states"
    created = of(launched, "ros_gz_sim/create")
    assert [item.arguments[:4] for item in created] == [
        ("-name", f"robot_{i}", "-topic", f"/robot_{i}_robot_description") for i in (1, 2)
    ]
    assert created[1].arguments[created[1].arguments.index("-y") + 1] == "2.0"
    spawners = [(item.namespace, item.arguments[0]) for item in of(launched, "controller_manager/spawner")]
    assert spawners == [
        ("/robot_1", "joint_state_broadcaster"),
        ("/robot_2", "joint_state_broadcaster"),
        ("/robot_1", "forward_velocity_controller"),
        ("/robot_2", "forward_velocity_controller"),
        ("/robot_1", "drive_controller"),
        ("/robot_2", "drive_controller"),
    ]
    assert {process.start_time for process in launched.processes} == {0.0}


def test_each_rovers_description_names_a_controllers_file_filled_in_for_it():
    for index, item in enumerate(of(evaluate(MAIN), "robot_state_publisher/robot_state_publisher"), start=1):
        (parameters,) = item.parameters
        robot = parse_urdf(parameters["robot_description"])
        assert robot.root_link == f"robot_{index}_base_link"
        (file,) = robot.controller_files
        assert f"- robot_{index}_front_left_wheel_joint" in Path(file).read_text()


def test_the_arm_takes_another_model(tmp_path):
    model = tmp_path / "other.urdf"
    model.write_text('<robot name="other"><link name="base"/></robot>')
    launched = evaluate(ARM, {"model": str(model)})
    (publisher,) = of(launched, "robot_state_publisher/robot_state_publisher")
    assert 'name="other"' in publisher.parameters[0]["robot_description"]
    assert Path(publisher.environment["GZ_SIM_RESOURCE_PATH"]).samefile(MODELS)


def test_the_arguments_are_shown():
    names = [
        item.name for item in declared_arguments(MODELS / "rover_gazebo" / "launch" / "spawn_with_control.launch.xml")
    ]
    assert names[:5] == ["robot_name", "x", "y", "z", "yaw"]
