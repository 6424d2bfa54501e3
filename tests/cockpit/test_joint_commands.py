import math

import pytest
from conftest import ARM

from drake_twin import TwinBuilder
from drake_twin.cockpit.joint_commands import JointCommands, joint_slider, slider_groups

ONE_JOINT = (
    '<robot name="r"><link name="world"/><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"'
    ' ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j" type="{type}"><parent link="world"/><child link="a"/>'
    '{limit}</joint><ros2_control name="s" type="system"><joint name="j"><command_interface name="{interface}"/>'
    '<state_interface name="position"/></joint></ros2_control></robot>'
)


def slider(folder, **values):
    file = folder / "r.urdf"
    file.write_text(ONE_JOINT.format(**values))
    ((slider,),) = [group.sliders for group in slider_groups(TwinBuilder().robot("r", file).build())]
    return slider


@pytest.mark.parametrize(
    ("type_", "interface", "limit", "unit", "bounds"),
    [
        ("continuous", "velocity", "", "rad/s", (-20, 20)),
        ("continuous", "velocity", '<limit effort="5" velocity="1e6"/>', "rad/s", (-20, 20)),
        ("revolute", "position", '<limit lower="-1" upper="2" effort="5" velocity="1"/>', "rad", (-1, 2)),
        ("continuous", "position", "", "rad", (-2 * math.pi, 2 * math.pi)),
        ("prismatic", "position", '<limit lower="0.5" upper="3" effort="5" velocity="1"/>', "m", (0.5, 3)),
        ("prismatic", "effort", '<limit lower="0" upper="3" effort="5" velocity="1"/>', "N", (-5, 5)),
        ("revolute", "effort", '<limit lower="0" upper="3" effort="1e9" velocity="1"/>', "N·m", (-200, 200)),
    ],
)
def test_a_slider_has_the_interfaces_unit_and_limits(tmp_path, type_, interface, limit, unit, bounds):
    made = slider(tmp_path, type=type_, interface=interface, limit=limit)
    assert made.unit == unit
    assert (made.lower, made.upper) == pytest.approx(bounds)


def test_a_position_that_nobody_commands_is_shown_where_the_joint_is(tmp_path):
    file = tmp_path / "r.urdf"
    limit = '<limit lower="-1" upper="2" effort="5" velocity="1"/>'
    file.write_text(ONE_JOINT.format(type="revolute", interface="position", limit=limit))
    twin = TwinBuilder().robot("r", file).build()
    commands = JointCommands(twin)
    (topic,) = commands.groups
    twin.entities.set_joint_positions("r", {"j": 0.75})
    assert commands.values(topic).tolist() == [0.75]
    commands.move(topic, 0, 5.0)  # beyond the limit
    assert commands.values(topic).tolist() == [2.0]


def test_a_joint_slider_has_the_joints_range():
    joints = TwinBuilder().robot("arm", ARM).build().built.plans[0].description.joints_by_name
    made = joint_slider(joints["joint_1"])
    assert (made.lower, made.upper) == (joints["joint_1"].limits.lower, joints["joint_1"].limits.upper)


@pytest.mark.parametrize(
    ("kind", "parameters"),
    [
        ("position_controllers/GripperActionController", "joint: j"),
        ("parallel_gripper_action_controller/GripperActionController", "joint: j"),
    ],
)
def test_a_gripper_has_a_slider_that_sends_goals(tmp_path, kind, parameters):
    file = tmp_path / "r.urdf"
    limit = '<limit lower="0" upper="0.5" effort="500" velocity="1"/>'
    file.write_text(ONE_JOINT.format(type="prismatic", interface="position", limit=limit))
    (tmp_path / "c.yaml").write_text(
        f"controller_manager:\n  ros__parameters:\n    grip: {{type: {kind}}}\n"
        f"grip:\n  ros__parameters: {{{parameters}}}\n"
    )
    twin = TwinBuilder().robot("r", file, controllers=tmp_path / "c.yaml").build()
    commands = JointCommands(twin)
    (topic,) = commands.groups
    assert (topic, commands.groups[topic].sliders[0].unit) == ("/r/grip/gripper_cmd", "m")
    commands.move(topic, 0, 0.3)
    twin.advance_to(3.0)
    assert twin.robot_state("r").positions[0] == pytest.approx(0.3, abs=0.01)
    assert commands.values(topic).tolist() == [0.3]
    commands.forget()
    assert commands.values(topic)[0] == pytest.approx(twin.robot_state("r").positions[0])
