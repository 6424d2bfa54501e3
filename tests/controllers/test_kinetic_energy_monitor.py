"""gz-sim's KineticEnergyMonitor: what is lost at a step, and the energy of a link that turns and moves."""

import numpy as np
import pytest
from controller_parameters import parameters_of
from device_harness import ROBOT, Running, setup_of
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.math import SpatialVelocity
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex, SpatialInertia, UnitInertia

from drake_twin import TwinBuilder
from drake_twin.controllers.kinetic_energy_monitor import KineticEnergyMonitor
from drake_twin.description.gazebo_drive import KINETIC_ENERGY_MONITOR
from drake_twin.errors import InputError
from drake_twin.findings import Kind
from drake_twin.scenario import World
from drake_twin.sensors.kinetic_energy_sensor import KineticEnergySensor

G = 9.8  # SDF's default


def test_a_loss_above_the_threshold_is_published_once():
    parameters = parameters_of(KINETIC_ENERGY_MONITOR, link_name="palm", kinetic_energy_threshold=2.0)
    run = Running(KineticEnergyMonitor(setup_of(KineticEnergyMonitor, parameters)), energy=[0.0], state=[0.0] * 4)
    told = []
    for number, energy in enumerate((10.0, 8.0, 5.5, 5.5, 9.0, 0.0)):
        run.fix("energy", [energy])
        run.advance(0.01 * (number + 1))
        message = run.output("kinetic_energy")
        told.append(None if message is None else message.data)
    assert told == [None, None, 2.5, None, None, 9.0]
    run.controller.deactivate(run.context)
    assert run.output("kinetic_energy") is None


def test_a_robot_without_the_link_is_a_problem():
    parameters = parameters_of(KINETIC_ENERGY_MONITOR, link_name="toe")
    assert KineticEnergyMonitor.problem(parameters, ROBOT) == "the robot has no link 'toe'"
    assert KineticEnergyMonitor.problem(parameters_of(KINETIC_ENERGY_MONITOR, link_name="palm"), ROBOT) is None


def test_the_energy_is_that_of_the_center_of_mass_and_of_the_turning_about_it():
    """½ m v² + ½ ω·I·ω, with I along the link's axes."""
    mass, inertia, center = 3.0, np.array([0.4, 0.5, 0.6]), np.array([0.1, -0.2, 0.3])
    about_center = SpatialInertia(mass, np.zeros(3), UnitInertia(*(inertia / mass)))
    plant = MultibodyPlant(0.0)
    plant.AddRigidBody("link", about_center.Shift(-center))
    plant.Finalize()
    turned = RollPitchYaw(0.3, -0.7, 1.1).ToRotationMatrix()
    omega, velocity = np.array([1.0, -2.0, 0.5]), np.array([0.3, 0.1, -0.4])
    poses = [RigidTransform(), RigidTransform(turned, [1.0, 2.0, 3.0])]
    velocities = [SpatialVelocity(np.zeros(6)), SpatialVelocity(omega, velocity)]
    sensor = KineticEnergySensor(BodyIndex(1), plant.GetBodyByName("link").default_spatial_inertia())
    context = sensor.CreateDefaultContext()
    for name, value in (("body_poses", poses), ("body_spatial_velocities", velocities)):
        sensor.GetInputPort(name).FixValue(context, make_port_value(name, value))
    v_center = velocity + np.cross(omega, turned @ center)
    in_link = turned.inverse() @ omega
    expected = 0.5 * mass * v_center @ v_center + 0.5 * in_link @ (inertia * in_link)
    assert sensor.GetOutputPort("energy").Eval(context)[0] == pytest.approx(expected, rel=1e-12)


def make_port_value(name, value):
    from drake_twin.sensors.plant_reader import _PORTS

    made = _PORTS[name][0]()
    made.set_value(value)
    return made


BALL = """<sdf version="1.9"><model name="ball"><link name="body"><inertial><mass>4</mass></inertial>
<collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link>
<plugin filename="gz-sim-kinetic-energy-monitor-system" name="gz::sim::systems::KineticEnergyMonitor">{}</plugin>
</model></sdf>"""


@pytest.fixture
def ball(tmp_path):
    """Builds a twin of a ball that falls from a height (m)."""

    def build(elements, height=1.0, time_step=0.001):
        (tmp_path / "ball.sdf").write_text(BALL.format(elements))
        builder = TwinBuilder(world=World(ground=True), time_step=time_step)
        return builder.robot("ball", tmp_path / "ball.sdf", xyz=(0, 0, height + 0.1)).build()

    return build


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_what_falls_loses_the_energy_of_its_height_where_it_lands(ball, time_step):
    """The speed after n steps of free fall is n·g·dt, and the first n·(n + 1)/2·g·dt² of 1 m or more is the ground."""
    twin = ball("<link_name>body</link_name><kinetic_energy_threshold>0</kinetic_energy_threshold>", 1.0, time_step)
    losses = []
    twin.subscribe("/ball/kinetic_energy", lambda message: losses.append((twin.time, message.data)))
    twin.advance_to(1.0)
    steps = next(n for n in range(1000) if n * (n + 1) / 2 * G * time_step**2 >= 1.0)
    assert losses[0][0] == pytest.approx(steps * time_step, abs=3 * time_step)
    assert sum(data for _, data in losses) == pytest.approx(0.5 * 4 * (steps * G * time_step) ** 2, rel=0.01)


def test_a_soft_landing_is_below_the_threshold_and_gz_has_one_of_7_joules(ball):
    for height, is_told in ((0.1, False), (1.0, True)):
        twin, losses = ball("<link_name>body</link_name><topic>/hit</topic>", height), []
        twin.subscribe("/ball/hit", losses.append)
        twin.advance_to(0.7)
        assert bool(losses) == is_told
        assert all(item.data > 7.0 for item in losses)


def test_a_restored_monitor_goes_on_to_the_same_bits(ball):
    twin = ball("<link_name>body</link_name>")
    twin.advance_to(0.3)
    snapshot = twin.snapshot()
    twin.advance_to(0.6)
    end = twin.state_sha256()
    twin.restore(snapshot)
    twin.advance_to(0.6)
    assert twin.state_sha256() == end


@pytest.mark.parametrize(
    ("elements", "why"),
    [("", "<link_name> is missing"), ("<link_name>hub</link_name>", "the robot has no link 'hub'")],
)
def test_a_plugin_that_cannot_work_is_a_finding(ball, elements, why):
    (finding,) = [item for item in ball(elements).findings if item.kind is Kind.NOT_STARTED]
    assert finding.what.endswith(f"kinetic_energy_monitor (gz-sim-kinetic-energy-monitor-system): {why}")


def test_a_bad_value_is_refused_with_its_file_and_line(ball):
    with pytest.raises(InputError) as raised:
        ball("<link_name>body</link_name><kinetic_energy_threshold>much</kinetic_energy_threshold>")
    place = "ball.sdf:3: <plugin filename='gz-sim-kinetic-energy-monitor-system'>: "
    assert f"{place}<kinetic_energy_threshold> is 'much', which is not a number" in str(raised.value)
