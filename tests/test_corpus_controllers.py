"""The controllers of packages that nobody here wrote, read from their own parameters files."""

import re
from dataclasses import replace

import pytest
import yaml
from conftest import CORPUS
from test_corpus import whole_robots

from drake_twin.builder.robot_file import planned_robots
from drake_twin.controllers.registry import controller_class, controller_types
from drake_twin.description.controllers_yaml import read_controllers
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.parameters import read_parameters
from drake_twin.errors import InputError
from drake_twin.planning.plan_robot import plan_robot

needs_corpus = pytest.mark.skipif(not CORPUS.is_dir(), reason="the folder shared/corpus is not here")

# What public launch files start, by how many repositories do.
COUNTED_TYPES = {
    "joint_trajectory_controller/JointTrajectoryController",
    "diff_drive_controller/DiffDriveController",
    "position_controllers/GripperActionController",
    "effort_controllers/GripperActionController",
    "forward_command_controller/ForwardCommandController",
    "imu_sensor_broadcaster/IMUSensorBroadcaster",
    "velocity_controllers/JointGroupVelocityController",
    "position_controllers/JointGroupPositionController",
    "parallel_gripper_action_controller/GripperActionController",
    "mecanum_drive_controller/MecanumDriveController",
    "tricycle_controller/TricycleController",
    "ackermann_steering_controller/AckermannSteeringController",
    "effort_controllers/JointGroupEffortController",
    "gpio_controllers/GpioCommandController",
}

# Types in the corpus that the twin has not: somebody's own.
FOREIGN_TYPES = {
    "passthrough_controller/PassthroughController",
    "ros2_control_demo_example_7/RobotController",
}


def controller_files():
    """The corpus's parameters files that give a controller manager its controllers."""
    if not CORPUS.is_dir():
        return []
    texts = {file: file.read_text(encoding="utf-8") for file in sorted(CORPUS.rglob("*.y*ml"))}
    return [file for file, text in texts.items() if "controller_manager" in text and "ros__parameters" in text]


def namespaces(file):
    """The namespaces that a parameters file writes for; the empty one where it writes for any."""
    text = re.sub(r"\$\(var \w+\)", "", file.read_text(encoding="utf-8"))
    keys = [str(key) for document in yaml.safe_load_all(text) for key in document or {}]
    named = {key.strip("/").split("/")[0] for key in keys if "/" in key.strip("/") or key.startswith("robot_")}
    return sorted(f"/{name}" for name in named - {"**"}) or [""]


def controllers_of(file):
    placeholders = dict.fromkeys(re.findall(r"\$\(var (\w+)\)", file.read_text(encoding="utf-8")), "")
    for namespace in namespaces(file):
        found = read_controllers(file, namespace, placeholders).controllers
        assert found, f"{file} has no controllers in the namespace {namespace!r}"
        yield from found


def test_every_type_that_public_launch_files_start_is_there():
    assert {*controller_types()} >= COUNTED_TYPES
    assert all(controller_class(kind) is not None for kind in COUNTED_TYPES)


@needs_corpus
def test_the_corpus_has_the_parameters_files_of_forty_robots():
    assert len(controller_files()) >= 40
    types = {controller.type for file in controller_files() for controller in controllers_of(file)}
    assert types - {*controller_types()} == FOREIGN_TYPES


@needs_corpus
@pytest.mark.parametrize("file", controller_files(), ids=lambda file: f"{file.parent.parent.name}-{file.stem}")
def test_each_controller_of_a_type_that_the_twin_has_is_read_with_its_parameters_class(file):
    for controller in controllers_of(file):
        if controller.type in FOREIGN_TYPES:
            continue
        kind = controller_class(controller.type).Parameters
        parameters, _ = read_parameters(kind, controller)
        assert isinstance(parameters, kind)


@needs_corpus
@pytest.mark.parametrize("file", whole_robots(), ids=lambda file: f"{file.parent.parent.parent.name}-{file.stem}")
def test_each_controller_of_a_robot_that_names_a_parameters_file_is_active_or_says_why_not(file):
    if "rosbot_xl" in file.name:  # its parts come from a package that is not in the corpus
        with pytest.raises(InputError, match="package 'ros_components_description' was not found in"):
            planned_robots(file, xacro_args={})
        return
    scenario = planned_robots(file, xacro_args={}).scenario
    (robot,) = scenario.robots
    plan = plan_robot(robot, PackageIndex(scenario.package_paths))
    if not plan.description.controller_files:
        assert plan.controllers == () or [text for text in plan.findings.not_started if "sensor" not in text] == []
        return
    assert plan.controllers
    said = "\n".join(plan.findings.not_started)
    for controller in plan.controllers:
        if controller.state == "inactive":
            assert f"controller {controller.name}: resource conflict, " in said
        elif controller.state == "unloaded":
            assert f"controller {controller.name}: {controller.problem}" in said
            assert "has no imu sensor" in controller.problem  # the one robot whose file names a sensor it lacks
        else:
            assert controller.problem is None


@needs_corpus
@pytest.mark.parametrize(
    ("example", "robot", "parameters", "active"),
    [
        (2, "diffbot", "diffbot_controllers", ["diffbot_base_controller"]),
        (
            3,
            "rrbot_system_multi_interface",
            "rrbot_multi_interface_forward_controllers",
            ["forward_velocity_controller"],
        ),
        (11, "carlikebot", "carlikebot_controllers", ["bicycle_steering_controller"]),
        (
            16,
            "diffbot",
            "diffbot_chained_controllers",
            ["pid_controller_left_wheel_joint", "pid_controller_right_wheel_joint", "diffbot_base_controller"],
        ),
    ],
)
def test_the_controllers_that_a_demo_starts_are_active_on_its_robot(example, robot, parameters, active):
    folder = CORPUS / "ros2_control_demos" / f"example_{example}"
    scenario = planned_robots(folder / "description" / "urdf" / f"{robot}.urdf.xacro", xacro_args={}).scenario
    with_controllers = replace(
        scenario.robots[0],
        controllers=(str(folder / "bringup" / "config" / f"{parameters}.yaml"),),
        active_controllers=("joint_state_broadcaster", *active),
    )
    plan = plan_robot(with_controllers, PackageIndex(scenario.package_paths))
    states = {controller.name: controller.state for controller in plan.controllers}
    assert [states[name] for name in active] == ["active"] * len(active)
    assert plan.findings.not_started == ()
