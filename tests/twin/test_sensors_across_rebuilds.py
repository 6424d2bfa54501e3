"""What sensors measure does not depend on whether the plant is a new one, which has made no step yet."""

import pytest
from conftest import ROVER
from living import living
from pydrake.geometry import SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Diagram, DiagramBuilder

from drake_twin import Twin, TwinBuilder
from drake_twin.scenario import Robot, World
from drake_twin.scenario.scenario_file import ScenarioFile
from drake_twin.sensors.sensor_host import SensorHost
from drake_twin.sensors.sensor_system import SensorSystem
from drake_twin.twin.snapshot import Snapshot

SWINGING = """
<robot name="r">
  <link name="base"><inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size=".4 .4 .2"/></geometry></collision></link>
  <link name="arm"><inertial><mass value=".5"/><origin xyz="0 0 .2"/>
    <inertia ixx=".01" iyy=".01" izz=".01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="j" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="1 0 0"/>
    <limit lower="-2" upper="2" effort="10" velocity="5"/></joint>
  <ros2_control name="s" type="system">
    <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
    <joint name="j"><command_interface name="position"/><state_interface name="position"/></joint>
    <sensor name="imu">
      <state_interface name="orientation.x"/><state_interface name="orientation.y"/>
      <state_interface name="orientation.z"/><state_interface name="orientation.w"/>
      <state_interface name="angular_velocity.x"/><state_interface name="angular_velocity.y"/>
      <state_interface name="angular_velocity.z"/><state_interface name="linear_acceleration.x"/>
      <state_interface name="linear_acceleration.y"/><state_interface name="linear_acceleration.z"/>
    </sensor>
    <sensor name="fts">
      <state_interface name="force.x"/><state_interface name="force.y"/><state_interface name="force.z"/>
      <state_interface name="torque.x"/><state_interface name="torque.y"/><state_interface name="torque.z"/>
    </sensor>
  </ros2_control>
  <gazebo reference="arm"><sensor name="imu" type="imu"><update_rate>100</update_rate></sensor></gazebo>
  <gazebo reference="j"><sensor name="fts" type="force_torque"><update_rate>100</update_rate></sensor></gazebo>
</robot>
"""
CONTROLLERS = """
controller_manager:
  ros__parameters:
    imu_broadcaster: {type: imu_sensor_broadcaster/IMUSensorBroadcaster}
    fts_broadcaster: {type: force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster}
    positions: {type: position_controllers/JointGroupPositionController}
imu_broadcaster: {ros__parameters: {sensor_name: imu, frame_id: arm}}
fts_broadcaster: {ros__parameters: {sensor_name: fts, frame_id: arm}}
positions: {ros__parameters: {joints: [j]}}
"""


@pytest.fixture
def twin(tmp_path):
    (tmp_path / "r.urdf").write_text(SWINGING)
    (tmp_path / "c.yaml").write_text(CONTROLLERS)
    twin = TwinBuilder().robot("r", tmp_path / "r.urdf", xyz=(0, 0, 0.1), controllers=tmp_path / "c.yaml").build()
    twin.publish("/r/positions/commands", [1.0])
    twin.advance_to(0.05)
    return twin


def measured(twin):
    turned, force = twin.latest("/r/imu_broadcaster/imu"), twin.latest("/r/fts_broadcaster/wrench").wrench
    return [
        getattr(vector, axis)
        for vector in (
            turned.orientation,
            turned.angular_velocity,
            turned.linear_acceleration,
            force.force,
            force.torque,
        )
        for axis in "xyz"
    ]


def test_a_spawn_and_a_delete_are_not_felt_by_sensors(twin):
    before = measured(twin)
    assert abs(before[7] ** 2 + before[8] ** 2 - 9.81**2) > 1.0  # it swings: this is not gravity at rest
    assert abs(before[11]) > 0.1
    same = pytest.approx(before, rel=1e-6, abs=1e-5)  # the accelerations of all come from one solve: to 1e-6 of gravity
    twin.entities.spawn(Robot("other", ROVER, xyz=(-3, 0, 0.13)))
    assert measured(twin) == same
    twin.entities.delete("other")
    assert measured(twin) == same
    twin.clock.set_time_step(0.002)  # over a longer step accelerations are others, but near
    assert measured(twin) == pytest.approx(before, rel=0.3, abs=0.1)
    twin.step(1)
    assert measured(twin) != same


def test_sensors_measure_the_same_in_a_state_that_was_saved(twin, tmp_path):
    before = measured(twin)
    twin.snapshot().save(tmp_path / "state.json")
    twin.step(1)
    after = measured(twin)
    saved = Snapshot.load(tmp_path / "state.json")
    other = Twin(ScenarioFile(saved.scenario, "saved").scenario)
    for each in (twin, other):
        each.restore(saved)
        assert measured(each) == before
        each.step(1)
        assert measured(each) == after


def test_a_place_that_is_set_turns_the_imu_at_once(twin):
    twin.entities.spawn(Robot("other", ROVER, xyz=(-3, 0, 0.13)))
    before = twin.latest("/r/imu_broadcaster/imu")
    twin.entities.set_joint_positions("r", {"j": 0.5})
    after = twin.latest("/r/imu_broadcaster/imu")
    assert abs(after.orientation.x - before.orientation.x) > 0.01


SENSORS = """<gazebo reference="arm"><sensor name="i" type="imu"/><sensor name="l" type="gpu_lidar"/>
  <sensor name="c" type="camera"/><sensor name="m" type="logical_camera"/></gazebo></robot>"""
WORLD = """<sdf version="1.9"><world name="w"><model name="wall"><static>true</static><link name="l">
  <sensor name="i" type="imu"/><collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link>
  </model></world></sdf>"""


def test_a_rebuild_leaves_nothing_of_the_diagram_before(tmp_path):
    """Neither the sensors, which refer to their system, nor the plants in which static models are read."""
    (tmp_path / "r.urdf").write_text(SWINGING.replace("</robot>", SENSORS))
    (tmp_path / "w.sdf").write_text(WORLD)
    twin = TwinBuilder(world=World(file=str(tmp_path / "w.sdf"), ground=True))
    twin = twin.robot("r", tmp_path / "r.urdf", xyz=(3, 0, 0.1)).build()
    twin.subscribe("/r/l/scan", lambda message: None)

    kinds = (MultibodyPlant, SceneGraph, DiagramBuilder, Diagram, SensorHost, SensorSystem)
    found = []
    for _ in range(4):
        twin.entities.spawn(Robot("other", ROVER, xyz=(-3, 0, 0.13)))
        twin.step()
        twin.entities.delete("other")
        twin.step()
        found.append(living(*kinds))
    assert found[-1] == found[0]
