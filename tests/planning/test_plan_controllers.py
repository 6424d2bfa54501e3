"""A robot with two joints, one of them with a slash in its name, and controllers that write to each other."""

import json
from math import isnan

import pytest

from drake_twin.controllers.registry import controller_class
from drake_twin.description.controllers_yaml import ControllerParameters, read_controllers
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.parameters import read_parameters
from drake_twin.errors import InputError
from drake_twin.planning.controller_plan import chained_to, is_chained
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.planning.plans import plan_robots
from drake_twin.scenario import Robot, Scenario

LINK = (
    '<link name="{}"><inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/>'
    "</inertial></link>"
)
JOINT = """<joint name="{0}" type="continuous"><parent link="base"/><child link="{1}"/><axis xyz="0 0 1"/>
  <limit effort="5" velocity="5"/></joint>"""
CONTROLLED = """<joint name="{}"><command_interface name="position"/>
  <command_interface name="velocity"/><command_interface name="effort"/>
  <state_interface name="position"/><state_interface name="velocity"/></joint>"""
ROBOT = f"""<robot name="r">{"".join(map(LINK.format, ("base", "one", "two")))}
  {JOINT.format("arm/left", "one")}{JOINT.format("wheel", "two")}
  <ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
  {CONTROLLED.format("arm/left")}{CONTROLLED.format("wheel")}</ros2_control></robot>"""


def forward(*joints, interface="velocity", **more):
    return "forward_command_controller/ForwardCommandController", {
        "joints": joints,
        "interface_name": interface,
        **more,
    }


def pid(*dofs, interface="effort", references=None, **more):
    """A PID of positions; its references are named after joints that it measures."""
    parameters = {"dof_names": dofs, "command_interface": interface, "reference_and_state_interfaces": ["position"]}
    measured = {} if references is None else {"reference_and_state_dof_names": references}
    return "pid_controller/PidController", parameters | measured | {"gains": {dof: {"p": 1.0} for dof in dofs}} | more


@pytest.fixture
def plan(tmp_path):
    def plan(manager=None, active=None, inactive=(), **controllers):
        types = {name: {"type": kind} for name, (kind, _) in controllers.items()}
        file = {"controller_manager": {"ros__parameters": {**types, **(manager or {})}}}
        file |= {name: {"ros__parameters": parameters} for name, (_, parameters) in controllers.items()}
        (tmp_path / "robot.urdf").write_text(ROBOT)
        (tmp_path / "c.yaml").write_text(json.dumps(file))
        robot = Robot(
            "r",
            str(tmp_path / "robot.urdf"),
            controllers=(str(tmp_path / "c.yaml"),),
            active_controllers=active,
            inactive_controllers=inactive,
        )
        return plan_robot(robot, PackageIndex())

    return plan


def states(plan):
    return {controller.name: controller.state for controller in plan.controllers}


def by_name(plan):
    return {controller.name: controller for controller in plan.controllers}


def test_a_slash_in_a_joints_name_is_no_chain_unless_a_controller_is_named_so(plan):
    plans = by_name(plan(direct=forward("arm/left")))
    assert plans["direct"].problem is None
    assert chained_to(plans["direct"], plans) == ()
    (claim,) = plans["direct"].claims
    assert not is_chained(claim, {"direct": None, "left": None})
    assert is_chained(claim, {"arm": None})


def test_a_joint_that_is_named_as_a_controller_is_no_chain(plan):
    plans = by_name(plan(wheel=forward("wheel")))
    assert states(plan(wheel=forward("wheel"))) == {"wheel": "active"}
    assert chained_to(plans["wheel"], plans) == ()


def test_a_controller_may_write_to_several(plan):
    plans = by_name(
        plan(
            first=pid("arm/left"),
            second=pid("wheel"),
            above=forward("first/arm/left", "second/wheel", interface="position"),
        )
    )
    assert chained_to(plans["above"], plans) == ("first", "second")
    assert [claim.joint for claim in plans["above"].claims] == ["first/arm/left", "second/wheel"]
    assert plans["above"].error is None


@pytest.mark.parametrize(
    ("joint", "interface"),
    [("pid/arm/left", "position"), ("pid/wheel", "velocity"), ("pid/wheel", "effort")],
)
def test_a_reference_that_a_controller_does_not_have_is_an_error_with_those_that_it_has(plan, joint, interface):
    with pytest.raises(InputError, match=rf"c\.yaml:\d+.* {joint}/{interface}.* Valid: pid/wheel/position") as error:
        raise plan(pid=pid("wheel"), above=forward(joint, interface=interface)).errors[0]
    assert "'pid'" in str(error.value)


@pytest.mark.parametrize("joint", ["nothing/wheel", "wheel/wheel"])
def test_a_reference_of_no_controller_is_a_joint_that_the_robot_lacks(plan, joint):
    (error,) = plan(pid=pid("wheel"), above=forward(joint, interface="position")).errors
    assert f"the robot has no joint '{joint}'" in str(error)


def test_controllers_that_write_to_each_other_in_a_circle_are_refused(plan):
    two = {"a": pid("b/wheel", interface="position", references=["wheel"])}
    two |= {"b": pid("a/wheel", interface="position", references=["wheel"])}
    with pytest.raises(InputError, match=r"c\.yaml.*the controllers (a, b|b, a) .* in a circle"):
        plan(**two)
    three = two | {"b": pid("c/wheel", interface="position", references=["wheel"])}
    three |= {"c": pid("a/wheel", interface="position", references=["wheel"])}
    with pytest.raises(InputError, match=r"the controllers .*a.* in a circle"):
        plan(**three)
    with pytest.raises(InputError, match=r"the controllers a .*in a circle"):
        plan(a=pid("a/wheel", interface="position", references=["wheel"]))


def test_a_circle_beside_another_chain_is_refused_too(plan):
    with pytest.raises(InputError, match="in a circle"):
        plan(
            below=pid("wheel"),
            a=pid("below/wheel", "c/wheel", interface="position", references=["wheel", "arm/left"]),
            c=pid("a/wheel", interface="position", references=["wheel"]),
        )


def test_of_two_that_write_one_reference_the_first_is_active(plan):
    writers = {name: forward("pid/wheel", interface="position") for name in ("first", "second")}
    found = plan(pid=pid("wheel"), **writers)
    assert states(found) == {"pid": "active", "first": "active", "second": "inactive"}
    (text,) = found.findings.not_started
    assert "pid/wheel/position is already claimed by first" in text


def test_a_writer_is_not_active_at_the_start_without_what_it_writes_to(plan):
    """As the switch of a running manager has it, and ros2_control's."""
    controllers = {"pid": pid("wheel"), "above": forward("pid/wheel", interface="position")}
    assert states(plan(active=("above",), inactive=("pid",), **controllers)) == {"above": "inactive", "pid": "inactive"}


def test_nothing_of_a_chain_above_an_inactive_controller_is_active_at_the_start(plan):
    found = plan(
        active=("top", "above"),
        inactive=("pid",),
        pid=pid("wheel"),
        above=pid("pid/wheel", interface="position", references=["wheel"]),
        top=forward("above/wheel", interface="position"),
    )
    assert states(found) == dict.fromkeys(("top", "above", "pid"), "inactive")
    texts = "\n".join(found.findings.not_started)
    assert "controller above: it writes to pid, which is not active" in texts
    assert "controller top: it writes to above, which is not active" in texts


def test_nothing_is_active_at_the_start_above_a_controller_whose_claims_are_taken(plan):
    found = plan(
        first=forward("wheel", interface="effort"),
        top=forward("pid/wheel", "arm/left", interface="position"),
        pid=pid("wheel"),
        last=forward("arm/left", interface="position"),
    )
    assert states(found) == {"first": "active", "top": "inactive", "pid": "inactive", "last": "active"}
    assert any("controller top: it writes to pid, which is not active" in text for text in found.findings.not_started)


def test_what_is_inactive_claims_nothing_and_conflicts_with_nothing(plan):
    one, other = forward("wheel"), forward("arm/left", "wheel")
    found = plan(one=one, other=other, inactive=("one",))
    assert states(found) == {"other": "active", "one": "inactive"}
    assert found.findings.not_started == ()
    assert states(plan(one=one, other=other, active=("one",), inactive=("one", "other"))) == {
        "one": "active",
        "other": "inactive",
    }


def test_what_another_one_keeps_from_starting_claims_nothing(plan):
    found = plan(one=forward("wheel"), two=forward("wheel", "arm/left"), three=forward("arm/left"))
    assert states(found) == {"one": "active", "two": "inactive", "three": "active"}


def test_a_controllers_rate_is_its_own_and_zero_is_the_managers(plan):
    found = by_name(
        plan(
            {"update_rate": 40},
            none=forward("wheel"),
            own=forward("wheel", update_rate=20),
            zero=forward("wheel", update_rate=0),
        )
    )
    assert {name: item.update_rate for name, item in found.items()} == {"none": 40, "own": 20, "zero": 40}


@pytest.mark.parametrize("rate", [-1, 1e9, True, "fast"])
def test_a_rate_that_is_none_is_refused_with_its_line(plan, rate):
    (error,) = plan(own=forward("wheel", update_rate=rate)).errors
    assert f"{rate!r} is not a rate (Hz)" in str(error)
    assert "c.yaml:" in str(error)


def test_a_joint_may_not_stand_twice(plan):
    (error,) = plan(one=forward("wheel", "arm/left", "wheel")).errors
    assert "duplicate joint 'wheel'" in str(error)


def test_a_robot_that_has_changed_is_planned_again(plan):
    known = plan(one=forward("wheel"))
    same = plan_robots(Scenario((known.robot,)), PackageIndex(), [known])
    assert same[0] is known
    (other,) = plan_robots(Scenario((Robot("r", known.robot.model, frame_prefix="x_"),)), PackageIndex(), [known])
    assert other.frame_prefix == "x_"


BICYCLE = {
    "traction_joints_names": ["wheel"],
    "steering_joints_names": ["steer"],
    "wheelbase": 1.0,
    "traction_wheel_radius": 0.1,
}


def test_speed_limits_of_a_steering_controller_are_those_of_plugins_only(tmp_path):
    file = tmp_path / "c.yaml"
    entry = {**BICYCLE, "linear.x.max_velocity": 1.0, "angular": {"z": {"max_velocity": 2.0}}}
    kind = "bicycle_steering_controller/BicycleSteeringController"
    manager = {"controller_manager": {"ros__parameters": {"c": {"type": kind}}}, "c": {"ros__parameters": entry}}
    file.write_text(json.dumps(manager, indent=1))
    (from_file,) = read_controllers(file, "/", {}).controllers
    from_plugin = ControllerParameters("c", kind, from_file.parameters)
    parameters, findings = read_parameters(controller_class(kind).Parameters, from_file)
    why = "is ignored: steering controllers of ros2_controllers have no speed limits"
    lines = file.read_text().splitlines()
    assert [finding.what for finding in findings] == [f"controller c: linear {why}", f"controller c: angular {why}"]
    assert ["linear" in lines[findings[0].lines[0] - 1], findings[1].file] == [True, str(file)]
    assert isnan(parameters.linear.x.max_velocity)
    parameters, findings = read_parameters(controller_class(kind).Parameters, from_plugin)
    assert (parameters.linear.x.max_velocity, parameters.angular.z.max_velocity, findings) == (1.0, 2.0, ())
