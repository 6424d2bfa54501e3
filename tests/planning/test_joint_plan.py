"""The bounds of position servos' gains, and where joints start."""

from pathlib import Path

import pytest

from drake_twin.description.package_index import PackageIndex
from drake_twin.errors import InputError
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.scenario import Robot

ARM = """<robot name="arm">
  <link name="base"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <ros2_control name="s" type="system">
    <hardware><param name="position_proportional_gain">{gain}</param></hardware></ros2_control></robot>"""


@pytest.fixture
def constant(tmp_path):
    """The time constant (s) of a robot's servos with a gain, at 100 Hz."""

    def constant_(gain):
        file = tmp_path / "arm.urdf"
        file.write_text(ARM.format(gain=gain))
        return plan_robot(Robot("arm", str(file)), PackageIndex()).joints.position_time_constant

    return constant_


@pytest.mark.parametrize("gain", [1e-8, 0.1, 1e4])
def test_a_gain_times_the_rate_is_the_servos_speed(constant, gain):
    assert constant(gain) == pytest.approx(1 / (100 * gain))


@pytest.mark.parametrize("gain", ["0.9e-8", "1.1e4"])
def test_a_servo_that_is_too_slow_or_too_fast_is_refused_with_its_line(constant, gain):
    with pytest.raises(InputError, match=rf"{gain}', and 100 Hz times that is not from 1e-06 to 1e\+06 1/s") as error:
        constant(gain)
    assert (Path(error.value.file).name, error.value.line) == ("arm.urdf", 5)


@pytest.mark.parametrize("gain", ["0", "-1", "nan", "fast"])
def test_a_gain_that_is_not_a_positive_number_is_refused(constant, gain):
    with pytest.raises(InputError, match=rf"position_proportional_gain is '{gain}', which is not a positive number"):
        constant(gain)


LIFT = """<robot name="lift">
  <link name="base"/><link name="fork"/>
  <joint name="mast" type="prismatic"><parent link="base"/><child link="fork"/>
    <limit lower="0" upper="1" effort="9" velocity="1"/></joint>
  <ros2_control name="s" type="system"><hardware/><joint name="mast">
    <state_interface name="position"><param name="initial_value">0.1</param></state_interface></joint></ros2_control>
  {plugin}</robot>"""
PLUGIN = """<gazebo><plugin filename="gz-sim-joint-position-controller-system" name="p">
  <joint_name>mast</joint_name><initial_position>0.2</initial_position></plugin></gazebo>"""


@pytest.mark.parametrize(
    ("plugin", "given", "start"),
    [
        ("", {}, 0.1),
        (PLUGIN, {}, 0.2),
        (PLUGIN, {"mast": 0.3}, 0.3),
        (PLUGIN, {"mast": 0.0}, 0.0),
        (PLUGIN, {"mast": 7.0}, 1.0),
    ],
)
def test_a_joint_starts_where_the_scenario_says_else_its_plugin_else_its_hardware(tmp_path, plugin, given, start):
    file = tmp_path / "lift.urdf"
    file.write_text(LIFT.format(plugin=plugin))
    plan = plan_robot(Robot("lift", str(file), initial_positions=given), PackageIndex())
    assert plan.joints.start_positions == {"mast": start}
