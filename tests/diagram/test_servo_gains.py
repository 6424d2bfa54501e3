import numpy as np
import pytest
from conftest import ARM, ROVER

from drake_twin import TwinBuilder
from drake_twin.diagram.servo_gains import JointLoad, position_gains, velocity_gains
from drake_twin.errors import InputError


def gains(twin, robot):
    instance = twin.plant.GetModelInstanceByName(robot)
    actuators = [twin.plant.get_joint_actuator(index) for index in twin.plant.GetJointActuatorIndices(instance)]
    return [(item.get_controller_gains().p, item.get_controller_gains().d) for item in actuators]


def test_a_velocity_servo_yields_by_its_bound_under_gravity():
    load = JointLoad(inertia=0.1, gravity=5.0, contact=0.0)
    assert load.gravity / velocity_gains(load).d <= 2.5e-4


def test_a_position_servo_sags_by_its_bound_and_is_overdamped():
    load = JointLoad(inertia=0.1, gravity=5.0, contact=0.0)
    position = position_gains(load)
    assert load.gravity / position.p <= 5e-4
    assert position.d**2 >= 4 * position.p * load.inertia


@pytest.mark.parametrize("make", [velocity_gains, position_gains])
def test_a_joint_without_any_load_still_has_damping(make):
    # Drake ends the process at the first step when p and d are both zero.
    assert make(JointLoad(inertia=1e-9, gravity=0.0, contact=0.0)).d > 0


def test_a_robots_gains_do_not_depend_on_its_neighbours():
    alone = TwinBuilder().robot("arm", ARM).build()
    crowded = TwinBuilder().robot("a", ROVER).robot("b", ARM, xyz=(9, 0, 0)).robot("arm", ARM, xyz=(0, 9, 0)).build()
    assert np.allclose(gains(alone, "arm"), gains(crowded, "arm"), rtol=1e-9)


def test_velocity_servos_have_no_stiffness_and_held_joints_have_some():
    twin = TwinBuilder().robot("arm", ARM).build()
    assert all(p > 0 and d > 0 for p, d in gains(twin, "arm"))
    twin.publish("/arm/forward_velocity_controller/commands", [0.1] * 4)
    twin.step()
    assert all(p == 0 and d > 0 for p, d in gains(twin, "arm"))


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_an_unclaimed_arm_holds_a_bent_start_position(time_step):
    start = {"joint_1": 0.5, "joint_2": 0.9, "joint_3": -0.6}
    twin = TwinBuilder(time_step=time_step).robot("arm", ARM, active_controllers=[], initial_positions=start).build()
    before = np.array(twin.robot_state("arm").positions)
    twin.advance_to(3.0)
    assert np.abs(np.array(twin.robot_state("arm").positions) - before).max() < 1e-3


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_a_commanded_joint_keeps_its_velocity_against_gravity(time_step):
    twin = TwinBuilder(time_step=time_step).robot("arm", ARM).build()
    twin.publish("/arm/forward_velocity_controller/commands", [1.0, 0.5, -0.5, 0.2])
    twin.advance_to(1.0)
    velocities = np.array(twin.robot_state("arm").velocities[:4])
    assert np.abs(velocities - (1.0, 0.5, -0.5, 0.2)).max() < 1e-3


def test_a_joint_whose_load_is_no_number_is_refused(tmp_path):
    inertial = (
        '<inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )
    (tmp_path / "r.urdf").write_text(
        f'<robot name="r"><link name="world"/><link name="a">{inertial}<link name="b">{inertial}'
        '<joint name="turn" type="continuous"><parent link="world"/><child link="a"/><axis xyz="0 0 1"/></joint>'
        '<joint name="rail" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/>'
        '<limit effort="1" velocity="1" lower="1e200" upper="1e201"/></joint>'
        '<ros2_control name="s" type="system"><hardware><plugin>p</plugin></hardware><joint name="turn">'
        '<command_interface name="velocity"/></joint></ros2_control></robot>'
    )
    with pytest.raises(InputError, match=r"r\.urdf: robot 'r': joint 'turn' cannot be driven: .* too large for"):
        TwinBuilder().robot("r", tmp_path / "r.urdf").build()
