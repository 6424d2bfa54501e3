"""A joint at its limits, under a load, and held by nothing: as mechanics says, and as DART does at 1 ms."""

from math import sin

import pytest
from scenes import ENGINES, G, every_engine

from drake_twin import TwinBuilder

ROBOT = """<robot name="r"><link name="world"/><link name="arm"><inertial><origin xyz="{reach} 0 0"/><mass value="1"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="j" type="revolute"><parent link="world"/><child link="arm"/><axis xyz="{axis}"/>
    <limit lower="-{bound}" upper="{bound}" effort="100" velocity="50"/></joint>
  <ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
    <joint name="j"><command_interface name="{interface}"/></joint></ros2_control></robot>"""
INERTIA = 0.1  # of the arm about its own center (kg m²)


def robot(folder, engine, interface, *, reach, axis, bound):
    (folder / "r.urdf").write_text(ROBOT.format(reach=reach, axis=axis, bound=bound, interface=interface))
    return TwinBuilder(**ENGINES[engine]).robot("r", folder / "r.urdf").build()


def angle(twin):
    return twin.robot_state("r").positions[0]


@every_engine
def test_a_joint_stops_at_its_limit_and_is_not_pushed_through_it(tmp_path, engine):
    twin = robot(tmp_path, engine, "effort", reach=0, axis="0 0 1", bound=1)
    topic = "/r/forward_effort_controller/commands"
    twin.publish(topic, [2.0])
    twin.advance_to(0.3)
    assert angle(twin) == pytest.approx(2.0 / INERTIA * 0.3**2 / 2, rel=0.05)
    twin.advance_to(1.0)
    assert angle(twin) == pytest.approx(1.0, abs=1e-3)
    twin.publish(topic, [100.0])
    twin.advance_to(2.0)
    assert angle(twin) == pytest.approx(1.0, abs=2e-3)


@every_engine
def test_a_position_servo_bears_a_weight_without_a_droop(tmp_path, engine):
    twin = robot(tmp_path, engine, "position", reach=1, axis="0 1 0", bound=3)
    twin.publish("/r/forward_position_controller/commands", [0.0])
    twin.advance_to(4.0)
    assert angle(twin) == pytest.approx(0.0, abs=2e-4)  # Gazebo's droop is 2e-13 rad, for its servo is a constraint


@pytest.mark.parametrize(("engine", "bound"), [("1ms", 2e-3), ("cenic", 1e-2)])
def test_a_pendulum_keeps_its_energy(figure, tmp_path, engine, bound):
    """DART at 1 ms: 1.4e-3 of the height of fall, the error of a first-order step."""
    twin = robot(tmp_path, engine, "effort", reach=1, axis="0 1 0", bound=30)
    worst = 0.0
    for hundredth in range(1, 1001):
        twin.advance_to(hundredth / 100)
        state = twin.robot_state("r")
        energy = (1 + INERTIA) * state.velocities[0] ** 2 / 2 - G * sin(state.positions[0])
        worst = max(worst, abs(energy) / G)
    assert figure("pendulum: error of the energy ÷ m g l", worst) < bound
