import numpy as np
import pytest
from conftest import ARM, ROVER

from drake_twin import TwinBuilder
from drake_twin.diagram.joint_loads import JointLoad
from drake_twin.diagram.servo_gains import (
    MODES,
    REST_VELOCITY,
    ServoGains,
    brake_gains,
    effort_gains,
    position_gains,
    velocity_gains,
)
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
    position = position_gains(load, 0.1)
    assert load.gravity / position.p <= 5e-4
    assert position.d**2 >= 4 * position.p * load.inertia


def test_a_velocity_servo_has_its_time_constant_where_nothing_but_inertia_resists():
    assert 0.1 / velocity_gains(JointLoad(inertia=0.1, gravity=0.0, contact=0.0)).d == pytest.approx(0.005)  # s


def test_a_velocity_servo_stays_behind_by_its_bound_under_viscous_damping():
    load = JointLoad(inertia=1e-6, gravity=0.0, contact=0.0, damping=2.0)
    assert load.damping / (velocity_gains(load).d + load.damping) <= 5e-4  # of the commanded velocity


@pytest.mark.parametrize("time_constant", [0.02, 0.2, 1.5])
def test_a_position_servo_approaches_at_the_error_over_its_time_constant_and_is_overdamped(time_constant):
    load = JointLoad(inertia=3.0, gravity=0.0, contact=0.0)
    gains = position_gains(load, time_constant)
    assert gains.d / gains.p == pytest.approx(time_constant)
    assert gains.d**2 >= 4 * gains.p * load.inertia
    assert gains.p <= 100 * load.inertia / time_constant**2  # and not stiffer than it has to be


def test_a_position_servo_has_its_effort_where_it_is_behind_by_a_centimeter_a_second():
    gains = position_gains(JointLoad(inertia=0.015, gravity=0.0, contact=0.0), 0.1, 20.0)
    assert gains.d * 1e-2 == pytest.approx(20.0)
    assert gains.d / gains.p == pytest.approx(0.1)


def test_an_effort_that_is_no_limit_makes_no_endless_stiffness():
    load = JointLoad(inertia=0.1, gravity=0.0, contact=0.0)
    assert position_gains(load, 0.1, 1e30).p == pytest.approx(1e5 * 16 * 0.1 / 0.1**2)


def test_a_position_servo_that_may_not_be_stiff_is_slower_and_as_damped():
    load = JointLoad(inertia=0.1, gravity=0.0, contact=0.0)
    gains = position_gains(load, 1e-3, 100.0, stiffest=1e4)
    assert gains.p == 1e4
    assert gains.d**2 >= 4 * gains.p * load.inertia * (1 - 1e-12)


def test_a_joint_brakes_with_all_its_effort_above_the_velocity_of_rest():
    load = JointLoad(inertia=0.1, gravity=5.0, contact=1.0)
    gains = brake_gains(load, 7.0)
    assert (gains.p, gains.d * REST_VELOCITY) == (0.0, pytest.approx(7.0))
    assert brake_gains(load, np.inf).d * REST_VELOCITY >= load.gravity + load.contact


@pytest.mark.parametrize(("effort", "velocity"), [(np.inf, 2.0), (7.0, np.inf), (7.0, 0.0)])
def test_an_effort_without_limits_has_no_gains(effort, velocity):
    assert effort_gains(effort, velocity).d < 1e-6


def test_each_way_of_driving_a_joint_has_its_gains_and_none_has_none_at_all():
    load = JointLoad(inertia=0.1, gravity=5.0, contact=0.0)
    position, velocity, brake = position_gains(load, 0.1), velocity_gains(load), brake_gains(load, 7.0)
    effort = effort_gains(7.0, 2.0)
    servo = ServoGains(position, velocity, brake, effort, 7.0)
    expected = {"hold": position, "position": position, "velocity": velocity, "up": velocity, "down": velocity}
    expected |= {"brake": brake, "rest": brake, "effort": effort}
    for mode, gains in expected.items():
        assert (servo.of(mode).p, servo.of(mode).d) == (gains.p, gains.d), mode
    for mode in {*MODES} - {*expected}:
        assert servo.of(mode).p == 0.0, mode
        assert 0.0 < servo.of(mode).d < 1e-6, mode  # Drake ends the process when both are zero


BODY = (
    '<link name="{}"><inertial><origin xyz="{}"/><mass value="{}"/>'
    '<inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)


def one_joint(
    folder,
    kind,
    axis,
    limits,
    *,
    mount="",
    origin="0 0 0",
    more="",
    kind_of="position",
    rate=100,
    gain="",
    time_step=None,
    **options,
):
    """A robot of a base of 10 kg and a part of 2 kg, its joint held."""
    (folder / "r.urdf").write_text(
        f'<robot name="r">{mount}{BODY.format("base", "0 0 0", 10)}{BODY.format("part", origin, 2)}'
        f'<joint name="j" type="{kind}"><parent link="base"/><child link="part"/><axis xyz="{axis}"/>'
        f"<limit {limits}/>{more}</joint>"
        '<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin>'
        f"{gain}</hardware>"
        f'<joint name="j"><command_interface name="{kind_of}"/></joint></ros2_control></robot>'
    )
    kind = f"forward_{kind_of}_controller"
    (folder / "r.yaml").write_text(
        f"controller_manager: {{ros__parameters: {{update_rate: {rate}, {kind}: {{type: {kind_of}_controllers/"
        f"JointGroup{kind_of.title()}Controller}}}}}}\n{kind}: {{ros__parameters: {{joints: [j]}}}}\n"
    )
    builder = TwinBuilder(time_step=time_step)
    return builder.robot("r", folder / "r.urdf", controllers=[folder / "r.yaml"], **options).build()


MOUNT = '<link name="world"/><joint name="m" type="fixed"><parent link="world"/><child link="base"/></joint>'
G = 9.81


def test_a_load_that_pulls_down_counts_as_one_that_pulls_up(tmp_path):
    for axis in ("0 0 1", "0 0 -1"):
        twin = one_joint(tmp_path, "prismatic", axis, 'lower="-1" upper="1" effort="30" velocity="1"', mount=MOUNT)
        ((p, _),) = gains(twin, "r")
        assert p == pytest.approx(2 * G / 5e-4, rel=1e-3)
        twin.advance_to(1.0)
        assert abs(twin.robot_state("r").positions[0]) == pytest.approx(5e-4, rel=0.01)


def test_a_load_that_comes_only_where_the_joint_goes_is_known_from_the_start(tmp_path):
    """A pendulum of 2 kg on 0.5 m that starts at rest and is to stand out: 9.81 N·m."""
    limits = 'lower="-1.6" upper="1.6" effort="100" velocity="3"'
    twin = one_joint(tmp_path, "revolute", "0 1 0", limits, mount=MOUNT, origin="0 0 -0.5", xyz=(0, 0, 2))
    ((p, _),) = gains(twin, "r")
    assert p >= 0.98 * 2 * G * 0.5 / 5e-4
    twin.publish("/r/forward_position_controller/commands", [1.5])
    twin.advance_to(3.0)
    assert abs(twin.robot_state("r").positions[0] - 1.5) < 6e-4


def test_a_position_yields_by_10_mrad_under_the_robots_weight():
    assert position_gains(JointLoad(inertia=1e-6, gravity=0.0, contact=12.0), 1.0).p == pytest.approx(1200)


def test_a_wheel_bears_the_robots_weight_at_its_radius_of_gyration(tmp_path):
    """The radius is √(0.02 / 2) = 0.1 m; a velocity yields by 10 mrad/s."""
    twin = one_joint(tmp_path, "continuous", "0 1 0", 'effort="1e6" velocity="9"', xyz=(0, 0, 5), kind_of="velocity")
    twin.publish("/r/forward_velocity_controller/commands", [1.0])
    twin.advance_to(0.01)
    ((_, d),) = gains(twin, "r")
    assert d == pytest.approx(12 * G * 0.1 / 1e-2, rel=1e-3)


def test_a_held_wheel_has_its_effort_a_millimeter_away(tmp_path):
    twin = one_joint(tmp_path, "continuous", "0 1 0", 'effort="5" velocity="9"', xyz=(0, 0, 5))
    ((p, _),) = gains(twin, "r")
    assert p * 1e-3 == pytest.approx(5.0)


def test_a_servo_overcomes_its_joints_dry_friction(tmp_path):
    friction = '<dynamics friction="0.7"/>'
    limits = 'lower="-1" upper="1" effort="1" velocity="9"'
    twin = one_joint(tmp_path, "revolute", "0 1 0", limits, mount=MOUNT, more=friction, xyz=(0, 0, 5))
    stiffness = [p for p, _ in gains(twin, "r") if p > 0]
    assert stiffness == [pytest.approx(0.7 / 5e-4, rel=1e-3)]


def test_a_joint_without_any_load_still_has_damping():
    # Drake ends the process at the first step when p and d are both zero.
    load = JointLoad(inertia=1e-9, gravity=0.0, contact=0.0)
    assert velocity_gains(load).d > 0
    assert position_gains(load, 0.1).d > 0


@pytest.mark.parametrize(("rate", "step"), [(500, 0.001), (1000, 0.001), (100, 0.01)])
def test_a_joint_that_nothing_pulls_at_comes_to_rest_at_any_rate(tmp_path, rate, step):
    """Drake's solver would not converge with the stiffness of so short a time constant."""
    gain = '<param name="position_proportional_gain">1.0</param>'
    limits = 'lower="-6" upper="6" effort="1000" velocity="9"'
    options = {"mount": MOUNT, "xyz": (0, 0, 5), "rate": rate, "gain": gain, "time_step": step}
    twin = one_joint(tmp_path, "revolute", "0 0 1", limits, **options)
    twin.publish("/r/forward_position_controller/commands", [1.0])
    twin.advance_to(2.0)
    assert twin.robot_state("r").positions[0] == pytest.approx(1.0, abs=1e-9)


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
