"""IMUs on links whose motion is known, in a plant with a step of 1 ms."""

from math import cos, pi, sin

import numpy as np
import pytest
from pydrake.math import RotationMatrix
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from drake_twin.description.robot_description import Pose, Sensor
from drake_twin.sensors.imu_sensor import ImuSensor, ImuSettings
from drake_twin.sensors.sensor_setup import SensorSetup

G = 9.81
INERTIA = (
    '<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
    '<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>'
)
BODY = f'<robot name="r"><link name="body">{INERTIA}</link></robot>'
TURNTABLE = f"""<robot name="r">
  <link name="base">{INERTIA.replace("collision", "ignored")}</link><link name="disc">{INERTIA}</link>
  <joint name="axle" type="continuous">
    <parent link="base"/><child link="disc"/><origin xyz="0 0 1" rpy="0 0 0"/><axis xyz="AXIS"/>
  </joint>
</robot>"""


class Rig:
    """A robot with one IMU."""

    def __init__(self, urdf, sensor, ground=False, weld=None, place=None, time_step=1e-3, reference=None):
        builder = DiagramBuilder()
        config = MultibodyPlantConfig(
            time_step=time_step, discrete_contact_approximation="lagged", use_sampled_output_ports=False
        )
        self.plant, _ = AddMultibodyPlant(config, builder)
        (instance,) = Parser(self.plant).AddModelsFromString(urdf, "urdf")
        if weld:
            self.plant.WeldFrames(self.plant.world_frame(), self.plant.GetFrameByName(weld))
        if ground:
            from pydrake.geometry import HalfSpace
            from pydrake.math import RigidTransform
            from pydrake.multibody.plant import CoulombFriction

            self.plant.RegisterCollisionGeometry(
                self.plant.world_body(), RigidTransform(), HalfSpace(), "ground", CoulombFriction(1.0, 1.0)
            )
        self.plant.Finalize()
        if place is not None:
            place(self.plant)
        self.imu = ImuSensor(SensorSetup(sensor, ImuSettings(reference, {}), self.plant, instance))
        builder.AddSystem(self.imu.host)
        for source, target in self.imu.host.inputs_from(self.plant):
            builder.Connect(source, target)
        self.simulator = Simulator(builder.Build())
        self.root = self.simulator.get_mutable_context()
        self.context = self.plant.GetMyMutableContextFromRoot(self.root)

    def measure(self, time=None):
        if time is not None:
            self.simulator.AdvanceTo(time)
        spatial = self.imu.output("spatial").Eval(self.imu.host.GetMyContextFromRoot(self.root))
        return spatial[:4], spatial[4:7], spatial[7:]


def turntable(axis, rate, pose, **options):
    rig = Rig(TURNTABLE.replace("AXIS", axis), Sensor("imu", "imu", link="disc", pose=pose), weld="base", **options)
    rig.plant.GetJointByName("axle").set_angular_rate(rig.context, rate)
    return rig


def test_at_rest_on_the_ground_it_measures_gravity_upwards():
    def above(plant):
        plant.SetDefaultPositions([1, 0, 0, 0, 0, 0, 0.1])

    rig = Rig(BODY, Sensor("imu", "imu", link="body"), ground=True, place=above)
    orientation, angular_velocity, acceleration = rig.measure(1.0)
    np.testing.assert_allclose(orientation, [1, 0, 0, 0], atol=1e-6)
    np.testing.assert_allclose(angular_velocity, 0.0, atol=1e-6)
    np.testing.assert_allclose(acceleration, [0, 0, G], atol=1e-4)


def test_in_free_fall_it_measures_nothing():
    _, _, acceleration = Rig(BODY, Sensor("imu", "imu", link="body", pose=Pose((0.1, 0.2, 0.3)))).measure(0.2)
    np.testing.assert_allclose(acceleration, 0.0, atol=1e-9)


def test_it_measures_before_the_first_step():
    _, _, falling = Rig(BODY, Sensor("imu", "imu", link="body")).measure()
    np.testing.assert_allclose(falling, 0.0, atol=1e-12)
    _, _, standing = Rig(BODY, Sensor("imu", "imu", link="body"), weld="body").measure()
    np.testing.assert_allclose(standing, [0, 0, G])


def test_a_tilted_imu_measures_gravity_in_its_own_axes():
    roll = 0.3
    rig = Rig(
        TURNTABLE.replace("AXIS", "0 0 1"),
        Sensor("imu", "imu", link="disc", pose=Pose(rpy=(roll, 0, 0))),
        weld="base",
        reference=(0, 0, 0),
    )
    orientation, _, acceleration = rig.measure(0.01)
    np.testing.assert_allclose(acceleration, [0, G * sin(roll), G * cos(roll)], atol=1e-12)
    np.testing.assert_allclose(orientation, [cos(roll / 2), sin(roll / 2), 0, 0], atol=1e-12)


@pytest.mark.parametrize("time_step", [1e-3, 1e-2])
def test_a_link_that_turns_about_the_vertical_gives_the_centripetal_acceleration(time_step):
    rate, x, y = 3.0, 0.4, -0.2
    rig = turntable("0 0 1", rate, Pose((x, y, 0.1)), time_step=time_step)
    orientation, angular_velocity, acceleration = rig.measure(0.5)
    np.testing.assert_allclose(angular_velocity, [0, 0, rate], atol=1e-12)
    np.testing.assert_allclose(acceleration, [-(rate**2) * x, -(rate**2) * y, G], atol=1e-9)
    np.testing.assert_allclose(orientation, [cos(rate * 0.25), 0, 0, sin(rate * 0.25)], atol=1e-9)


def test_a_tilted_imu_measures_the_angular_velocity_in_its_own_axes():
    pitch, rate = 0.4, 3.0
    rig = turntable("0 0 1", rate, Pose(rpy=(0, pitch, 0)))
    _, angular_velocity, _ = rig.measure(0.5)
    np.testing.assert_allclose(angular_velocity, [-rate * sin(pitch), 0, rate * cos(pitch)], atol=1e-12)


def test_gravity_does_not_lean_when_the_link_turns_about_a_level_axis():
    # With acceleration and orientation from either end of a step, gravity would lean by rate · 1 ms · 9.81 = 0.03.
    rate, radius = 3.0, 0.4
    rig = turntable("1 0 0", rate, Pose((0, radius, 0)))
    _, angular_velocity, acceleration = rig.measure(0.5)
    angle = rate * 0.5
    expected = [0, G * sin(angle) - rate**2 * radius, G * cos(angle)]
    np.testing.assert_allclose(acceleration, expected, atol=1e-9)
    np.testing.assert_allclose(angular_velocity, [rate, 0, 0], atol=1e-12)


def test_an_imu_on_a_swinging_pendulum_feels_only_what_pulls_along_the_rod():
    # A point mass swinging freely has a tangential acceleration of g·sin, which an IMU at the mass cannot feel.
    length, start = 0.8, 1.0
    rod = f"""<robot name="r"><link name="base"/><link name="rod">
      <inertial><origin xyz="0 0 {-length}"/><mass value="1"/>
      <inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="axle" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="1 0 0"/></joint>
    </robot>"""
    rig = Rig(rod, Sensor("imu", "imu", link="rod", pose=Pose((0, 0, -length))), weld="base", time_step=1e-4)
    axle = rig.plant.GetJointByName("axle")
    axle.set_angle(rig.context, start)
    _, _, acceleration = rig.measure(0.3)
    angle = axle.get_angle(rig.context)
    # Energy: ω² = 2 g (cos θ - cos θ₀)/l; the rod pulls with m (g cos θ + ω² l), towards the axle (+z).
    tension = G * cos(angle) + 2 * G * (cos(angle) - cos(start))
    np.testing.assert_allclose(acceleration, [0, 0, tension], atol=0.02)
    assert abs(acceleration[1]) < 1e-9


def test_the_orientation_is_relative_to_the_start_unless_the_sensor_has_a_reference():
    def turned(plant):
        plant.SetDefaultPositions([cos(pi / 4), 0, 0, sin(pi / 4), 0, 0, 5])

    for reference, expected in (
        (None, [1, 0, 0, 0]),
        ((0.0, 0.0, 0.0), [cos(pi / 4), 0, 0, sin(pi / 4)]),
        ((0.0, 0.0, pi / 2), [1, 0, 0, 0]),
    ):
        rig = Rig(BODY, Sensor("imu", "imu", link="body"), place=turned, reference=reference)
        orientation, _, _ = rig.measure()
        np.testing.assert_allclose(orientation, expected, atol=1e-12)


def test_a_level_robot_is_seen_from_north_east_down_as_upside_down():
    orientation, _, _ = Rig(BODY, Sensor("imu", "imu", link="body"), reference=(pi, 0.0, pi / 2)).measure()
    from pydrake.common.eigen_geometry import Quaternion

    R_NS = RotationMatrix(Quaternion(orientation)).matrix()
    # Its x axis points east, which is y in north-east-down; its z axis points up, which is -z there.
    np.testing.assert_allclose(R_NS[:, 0], [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(R_NS[:, 2], [0, 0, -1], atol=1e-12)


@pytest.mark.parametrize(("angle", "rate"), [(0.3, 0.0), (-1.1, 2.5), (2.0, -4.0), (3.1, 0.7)])
def test_a_pendulum_at_any_angle_and_rate_has_the_acceleration_of_the_closed_form(angle, rate):
    """At the point mass on a rod the IMU feels what pulls along the rod, m (g cos θ + ω² l), and nothing else."""
    length = 0.8
    rod = f"""<robot name="r"><link name="base"/><link name="rod">
      <inertial><origin xyz="0 0 {-length}"/><mass value="1"/>
      <inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="axle" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="1 0 0"/></joint>
    </robot>"""
    rig = Rig(rod, Sensor("imu", "imu", link="rod", pose=Pose((0, 0, -length))), weld="base")
    axle = rig.plant.GetJointByName("axle")
    axle.set_angle(rig.context, angle)
    axle.set_angular_rate(rig.context, rate)
    _, angular_velocity, acceleration = rig.measure()
    np.testing.assert_allclose(acceleration, [0, 0, G * cos(angle) + rate**2 * length], atol=1e-6)
    np.testing.assert_allclose(angular_velocity, [rate, 0, 0], atol=1e-12)
