"""Force/torque sensors against statics, and against Pinocchio's inverse dynamics."""

from math import cos, sin

import numpy as np
import pytest
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from rig import twin_with, xyz

from drake_twin.description.robot_description import Pose, Sensor
from drake_twin.sensors.force_torque_sensor import ForceTorqueSensor, ForceTorqueSettings
from drake_twin.sensors.sensor_setup import SensorSetup

G, MASS, LEVER = 9.81, 1.5, 0.4

ARM = f"""<robot name="arm">
  <link name="base"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="upper"><inertial><origin xyz="0.1 0.02 0.05" rpy="0.1 0.2 0.3"/><mass value="2"/>
    <inertia ixx="0.03" iyy="0.02" izz="0.04" ixy="0.001" ixz="0" iyz="0.002"/></inertial></link>
  <link name="lower"><inertial><origin xyz="{LEVER} 0 0"/><mass value="{MASS}"/>
    <inertia ixx="0.01" iyy="0.02" izz="0.015" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
    <origin xyz="0 0 0.5" rpy="0.2 0 0"/><axis xyz="0 0.6 0.8"/>
    <limit lower="-9" upper="9" effort="99" velocity="99"/></joint>
  <joint name="wrist" type="WRIST"><parent link="upper"/><child link="lower"/>
    <origin xyz="0.3 0 0" rpy="0 0.5 0"/><axis xyz="1 0 0"/>
    <limit lower="-9" upper="9" effort="99" velocity="99"/></joint>
</robot>"""
LEVEL = f"""<robot name="lever">
  <link name="base"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="weight"><inertial><origin xyz="{LEVER} 0 0"/><mass value="{MASS}"/>
    <inertia ixx="0.01" iyy="0.02" izz="0.015" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="mount" type="fixed"><parent link="base"/><child link="weight"/>
    <origin xyz="0 0 1" rpy="ROLL 0 0"/></joint>
</robot>"""


class Rig:
    """A robot fixed to the world, with one force/torque sensor."""

    def __init__(self, urdf, sensor, time_step=1e-3, **settings):
        builder = DiagramBuilder()
        config = MultibodyPlantConfig(
            time_step=time_step, discrete_contact_approximation="lagged", use_sampled_output_ports=False
        )
        self.plant, _ = AddMultibodyPlant(config, builder)
        (instance,) = Parser(self.plant).AddModelsFromString(urdf, "urdf")
        self.plant.WeldFrames(self.plant.world_frame(), self.plant.GetFrameByName("base"))
        self.plant.Finalize()
        self.sensor = ForceTorqueSensor(SensorSetup(sensor, ForceTorqueSettings(**settings), self.plant, instance))
        builder.AddSystem(self.sensor.host)
        for source, target in self.sensor.host.inputs_from(self.plant):
            builder.Connect(source, target)
        self.simulator = Simulator(builder.Build())
        self.root = self.simulator.get_mutable_context()
        self.context = self.plant.GetMyMutableContextFromRoot(self.root)

    def wrench(self):
        return self.sensor.output("wrench").Eval(self.sensor.host.GetMyContextFromRoot(self.root))


def statically(roll=0.0, pose=Pose(), **settings):  # noqa: B008
    rig = Rig(LEVEL.replace("ROLL", str(roll)), Sensor("fts", "force_torque", joint="mount", pose=pose), **settings)
    rig.simulator.AdvanceTo(0.01)
    return rig.wrench()


def test_a_weight_on_a_level_lever_pulls_the_parent_down_and_turns_it():
    # The child's weight acts on the parent: m·g downwards, at LEVER along x: the torque x × -z = +y.
    np.testing.assert_allclose(statically(), [0, 0, -MASS * G, 0, LEVER * MASS * G, 0], atol=1e-9)


def test_parent_to_child_is_what_holds_the_weight():
    np.testing.assert_allclose(statically(measured_on="child"), [0, 0, MASS * G, 0, -LEVER * MASS * G, 0], atol=1e-9)


def test_the_axes_are_the_childs_the_parents_or_the_sensors():
    roll, weight = 0.3, MASS * G
    of_child = [0, -weight * sin(roll), -weight * cos(roll)]
    np.testing.assert_allclose(statically(roll)[:3], of_child, atol=1e-9)
    np.testing.assert_allclose(statically(roll, axes="parent")[:3], [0, 0, -weight], atol=1e-9)
    upright = Pose(rpy=(-roll, 0, 0))
    np.testing.assert_allclose(statically(roll, axes="sensor", pose=upright)[:3], [0, 0, -weight], atol=1e-9)
    np.testing.assert_allclose(statically(roll, axes="child", pose=upright)[:3], of_child, atol=1e-9)


def test_the_torque_is_about_the_sensors_origin():
    np.testing.assert_allclose(statically(pose=Pose((LEVER, 0, 0))), [0, 0, -MASS * G, 0, 0, 0], atol=1e-9)
    wrench = statically(pose=Pose((LEVER - 0.1, 0, 0)), axes="sensor")
    np.testing.assert_allclose(wrench[3:], [0, 0.1 * MASS * G, 0], atol=1e-9)


def test_it_measures_before_the_first_step():
    rig = Rig(LEVEL.replace("ROLL", "0"), Sensor("fts", "force_torque", joint="mount"))
    before = rig.wrench()
    rig.simulator.AdvanceTo(0.01)
    np.testing.assert_allclose(before, rig.wrench(), atol=1e-12)
    assert abs(before[2]) == pytest.approx(MASS * G)


@pytest.mark.parametrize("wrist", ["revolute", "fixed"])
def test_a_falling_arm_has_the_forces_of_pinocchios_inverse_dynamics(wrist):
    pinocchio = pytest.importorskip("pinocchio")
    urdf = ARM.replace("WRIST", wrist)
    rig = Rig(urdf, Sensor("fts", "force_torque", joint="wrist"), measured_on="child")
    plant, context = rig.plant, rig.context
    plant.SetVelocities(context, np.array([2.0, -5.0])[: plant.num_velocities()])
    rig.simulator.AdvanceTo(0.3)
    q, v = plant.GetPositions(context), plant.GetVelocities(context)
    measured = rig.wrench()
    rig.simulator.AdvanceTo(0.301)
    acceleration = (plant.GetVelocities(context) - v) / 1e-3
    model = pinocchio.buildModelFromXML(urdf)
    data = model.createData()
    pinocchio.rnea(model, data, q, v, acceleration)
    if wrist == "revolute":
        expected = data.f[model.getJointId("wrist")].vector
    else:  # Pinocchio lumps welded links: the wrench on the lower link is what accelerates its own inertia
        frame = model.getFrameId("lower")
        pinocchio.forwardKinematics(model, data, q, v, acceleration)
        pinocchio.updateFramePlacements(model, data)
        motion = pinocchio.getFrameVelocity(model, data, frame)
        change = pinocchio.getFrameAcceleration(model, data, frame)
        gravity = data.oMf[frame].actInv(pinocchio.Motion(np.array([0, 0, -G]), np.zeros(3)))
        inertia = pinocchio.Inertia(MASS, np.array([LEVER, 0, 0]), np.diag([0.01, 0.02, 0.015]))
        expected = (inertia * (change - gravity) + motion.cross(inertia * motion)).vector
    np.testing.assert_allclose(measured, expected, atol=1e-8)


def test_a_sensor_publishes_what_its_broadcaster_would_and_classics_plugin_the_opposite(tmp_path):
    arm = """<robot name="box"><link name="box"/><link name="load"><inertial><mass value="2"/>
      <inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="j" type="fixed"><parent link="box"/><child link="load"/></joint>
      <link name="world"/><joint name="w" type="fixed"><parent link="world"/><child link="box"/></joint>{}</robot>"""
    sensor = '<gazebo reference="j"><sensor name="ft" type="force_torque"><topic>wrench</topic></sensor></gazebo>'
    plugin = """<gazebo><plugin name="f" filename="libgazebo_ros_ft_sensor.so"><joint_name>j</joint_name>
      <update_rate>50</update_rate></plugin></gazebo>"""
    (tmp_path / "arm").mkdir()
    twin = twin_with(tmp_path / "arm", sensor, plugin, body=arm, world=None)
    twin.advance_to(0.01)
    assert xyz(twin.latest("/box/wrench").wrench.force) == pytest.approx([0, 0, -2 * G])
    assert any(
        "publishes on /box/wrench, too" in warning for warning in twin.findings.warnings
    )  # the plugin's is the same
    twin = twin_with(tmp_path / "arm", plugin, body=arm, world=None)
    message = twin.latest("/box/wrench")
    assert xyz(message.wrench.force) == pytest.approx([0, 0, 2 * G])  # body2Force: on the child
    assert message.header.frame_id == "box/load"
