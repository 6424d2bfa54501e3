"""The parameters of a robot's controllers: files, what a scenario adds and replaces, prefixes, and none at all."""

import json

import pytest

from drake_twin.description.package_index import PackageIndex
from drake_twin.errors import InputError
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.scenario import Robot, ScenarioError

JOINT = (
    '<joint name="{0}" type="continuous"><parent link="base"/><child link="{0}_link"/></joint><link name="{0}_link"/>'
)
CONTROLLED = '<joint name="{}"><command_interface name="velocity"/><state_interface name="position"/></joint>'
ROBOT = f"""<robot name="r"><link name="base"/>{JOINT.format("left")}{JOINT.format("right")}
  <ros2_control name="s" type="system"><hardware><plugin>mock_components/GenericSystem</plugin></hardware>
  {CONTROLLED.format("left")}{CONTROLLED.format("right")}</ros2_control>{{}}</robot>"""
FORWARD = "forward_command_controller/ForwardCommandController"
FILE = {
    "controller_manager": {"ros__parameters": {"update_rate": 20, "one": {"type": FORWARD}}},
    "one": {"ros__parameters": {"joints": ["left"], "interface_name": "velocity"}},
}


@pytest.fixture
def plan(tmp_path):
    def plan(file=FILE, more="", **options):
        (tmp_path / "r.urdf").write_text(ROBOT.format(more))
        if file is not None:
            (tmp_path / "c.yaml").write_text(json.dumps(file))
            options.setdefault("controllers", (str(tmp_path / "c.yaml"),))
        found = plan_robot(Robot("r", str(tmp_path / "r.urdf"), **options), PackageIndex())
        return found, {item.name: item for item in found.controllers}

    return plan


def joints(controller):
    return [claim.joint for claim in controller.claims]


def test_a_scenario_replaces_parameters_of_a_file_by_their_names_with_dots(plan):
    found, controllers = plan(controller_parameters={"one": {"joints": ["right"], "update_rate": 10}})
    assert (joints(controllers["one"]), controllers["one"].update_rate, found.manager.update_rate) == (
        ["right"],
        10,
        20,
    )
    assert joints(plan()[1]["one"]) == ["left"]
    pid = {"type": "pid_controller/PidController", "dof_names": ["left"], "command_interface": "velocity"}
    pid |= {"reference_and_state_interfaces": ["position"], "gains": {"left": {"p": 1.0, "d": 3.0}}}
    _, controllers = plan(added_controllers={"pid": pid}, controller_parameters={"pid": {"gains.left.p": 2.0}})
    gains = controllers["pid"].parameters.gains["left"]
    assert (gains.p, gains.d, pid["gains"]["left"]["p"]) == (2.0, 3.0, 1.0)


def test_parameters_of_a_controller_that_there_is_not_are_refused_with_those_there_are(plan):
    with pytest.raises(ScenarioError, match=r"^controller_parameters\.two: .*no controller 'two'.* Valid: one"):
        plan(controller_parameters={"two": {"joints": []}})


def test_an_added_controller_is_beside_those_of_the_file_and_alone_without_one(plan):
    added = {"two": {"type": FORWARD, "joints": ["right"], "interface_name": "velocity"}}
    assert {name: joints(item) for name, item in plan(added_controllers=added)[1].items()} == {
        "two": ["right"],
        "one": ["left"],
    }
    assert [*plan(None, added_controllers=added)[1]] == ["two"]


@pytest.mark.parametrize(
    ("added", "why"),
    [({"one": {"type": FORWARD}}, "have a controller of this name"), ({"two": {}}, "the controller has no type")],
)
def test_an_added_controller_without_a_type_or_of_a_known_name_is_refused(plan, added, why):
    with pytest.raises(ScenarioError, match=rf"^added_controllers\.{next(iter(added))}: .*{why}"):
        plan(added_controllers=added)


def test_a_file_that_is_missing_is_named_at_its_place_in_the_scenario(plan):
    with pytest.raises(ScenarioError, match=r"^controllers: .*gone\.yaml"):
        plan(controllers=("/gone.yaml",))


def test_without_files_each_joint_is_commanded_and_its_state_is_published(plan):
    _, controllers = plan(None)
    assert {name: joints(item) for name, item in controllers.items()} == {
        "joint_state_broadcaster": [],
        "forward_velocity_controller": ["left", "right"],
    }


def test_a_file_for_another_namespace_has_no_controllers_and_that_is_said(plan):
    found, controllers = plan({"/elsewhere": FILE})
    assert controllers == {}
    (what,) = [item.what for item in found.findings if "no controllers found" in item.what]
    assert "for the namespace '/r'" in what


def test_the_namespace_of_the_plugin_counts_where_the_robots_has_none(plan):
    ros = "<ros><namespace>/ns</namespace></ros>"
    plugin = f'<gazebo><plugin name="c" filename="libgz_ros2_control-system.so">{ros}</plugin></gazebo>'
    assert [*plan({"/ns": FILE}, plugin)[1]] == ["one"]


def test_hardware_that_there_is_not_is_said_and_other_hardware_has_its_state(plan):
    manager = {"hardware_components_initial_state": {"inactive": ["s"], "unconfigured": ["t"]}}
    file = FILE | {"controller_manager": {"ros__parameters": FILE["controller_manager"]["ros__parameters"] | manager}}
    found, controllers = plan(file)
    assert found.hardware_states == {"s": "inactive"}
    assert controllers["one"].state == "inactive"
    (what,) = [item.what for item in found.findings if "is unknown" in item.what]
    assert what == "hardware component 't' is unknown, so it is not set to unconfigured"


def test_a_wrong_value_of_a_file_is_refused_with_its_line(plan):
    file = FILE | {"one": {"ros__parameters": {"joints": ["left", "middle"], "interface_name": "velocity"}}}
    found, _ = plan(file)
    assert [isinstance(error, InputError) and "no joint 'middle'" in str(error) for error in found.errors] == [True]


def test_a_prefix_of_the_xacro_file_is_found_in_parameters_without_it_at_any_depth(tmp_path):
    text = (
        ROBOT.format("")
        .replace('"left', '"$(arg prefix)left')
        .replace(
            '<robot name="r">',
            '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="prefix" default=""/>',
        )
    )
    (tmp_path / "r.urdf.xacro").write_text(text)
    pid = {"type": "pid_controller/PidController", "dof_names": ["left"], "command_interface": "velocity"}
    pid |= {"reference_and_state_interfaces": ["position"], "gains": {"left": {"p": 2.0}}}
    arguments = {"prefix": "r1_"}
    robot = Robot("r", str(tmp_path / "r.urdf.xacro"), xacro_args=arguments, added_controllers={"pid": pid})
    (controller,) = plan_robot(robot, PackageIndex()).controllers
    assert joints(controller) == ["r1_left"]
    assert controller.parameters.gains["r1_left"].p == 2.0


def test_a_parameters_file_that_is_gone_is_refused_with_the_line_of_the_plugin_that_names_it(tmp_path):
    file = tmp_path / "r.urdf"
    plugin = '<plugin filename="gz_ros2_control-system" name="c"><parameters>/gone/c.yaml</parameters></plugin>'
    file.write_text(f'<robot name="r"><link name="l"/>\n<gazebo>\n{plugin}</gazebo></robot>')
    with pytest.raises(InputError, match=rf"^{file}:3: the ros2_control plugin's parameters file: /gone/c.yaml"):
        plan_robot(Robot("r", str(file)), PackageIndex((), {}))
