"""The ports of a plant that only holds the state have what those who step its robots say."""

import numpy as np
import pytest
from pydrake.multibody.math import SpatialAcceleration, SpatialForce
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from drake_twin.systems.plant_reading import PlantPorts, held, holds_state, physics_step
from drake_twin.systems.steps_elsewhere import StepsElsewhere

ARM = """<robot name="{}"><link name="world"/><link name="l"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><parent link="world"/><child link="l"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="3" velocity="1"/></joint>{}</robot>"""
MOTOR = """<transmission name="t"><type>transmission_interface/SimpleTransmission</type>
<joint name="j"><hardwareInterface>EffortJointInterface</hardwareInterface></joint><actuator name="m"/>
</transmission>"""


class Told:
    """Says what it was told, and counts how often it is asked."""

    def __init__(self):
        self.efforts, self.asked = np.array([1.0, 2.0]), 0

    def net_actuation(self):
        self.asked += 1
        return self.efforts

    def body_spatial_accelerations(self):
        return [SpatialAcceleration.Zero()] * 3

    def reaction_forces(self):
        return [SpatialForce(tau=np.zeros(3), f=np.array([0.0, 0.0, 7.0]))]

    def contact_results(self):
        return "none touch"


@pytest.fixture
def plant():
    plant = MultibodyPlant(held(0.001))
    for name, motor in (("one", MOTOR), ("two", MOTOR), ("three", "")):
        Parser(plant).AddModelsFromString(ARM.format(name, motor), "urdf")
    plant.Finalize()
    return plant


@pytest.fixture
def told():
    return Told()


@pytest.fixture
def dut(plant, told):
    names = ("one", "two", "three")
    dut = StepsElsewhere(plant, {name: plant.GetModelInstanceByName(name) for name in names})
    dut.ask(told)
    return dut


def test_each_port_has_what_the_solutions_say(plant, dut):
    context = dut.CreateDefaultContext()
    assert dut.port("net_actuation").Eval(context).tolist() == [1.0, 2.0]
    for name, effort in (("one", [1.0]), ("two", [2.0])):
        assert dut.net_actuation(plant.GetModelInstanceByName(name)).Eval(context).tolist() == effort
    assert dut.port("reaction_forces").Eval(context)[0].translational().tolist() == [0.0, 0.0, 7.0]
    assert len(dut.port("body_spatial_accelerations").Eval(context)) == 3
    assert dut.port("contact_results").Eval(context) == "none touch"


def test_a_robot_without_motors_has_the_plants_empty_port(plant, dut):
    instance = plant.GetModelInstanceByName("three")
    assert dut.net_actuation(instance).get_system() is plant
    assert dut.net_actuation(instance).size() == 0


def test_they_are_asked_again_once_an_input_has_changed(plant, dut, told):
    context = dut.CreateDefaultContext()
    state = dut.GetInputPort("state").FixValue(context, np.zeros(plant.num_multibody_states()))
    for _ in range(2):
        dut.port("net_actuation").Eval(context)
    assert told.asked == 1
    state.GetMutableData().get_mutable_value().SetFromVector(np.ones(plant.num_multibody_states()))
    told.efforts = np.array([5.0, 6.0])
    assert dut.port("net_actuation").Eval(context).tolist() == [5.0, 6.0]


def test_without_islands_they_have_no_value(dut):
    dut.ask(Told())  # nobody keeps it
    with pytest.raises(RuntimeError, match="build a Twin"):
        dut.port("net_actuation").Eval(dut.CreateDefaultContext())


def test_the_ports_are_the_plants_own_where_it_steps_and_these_where_it_holds_the_state(plant, dut):
    instance = plant.GetModelInstanceByName("one")
    assert PlantPorts(plant).net_actuation(instance).get_system() is plant
    ports = PlantPorts(plant, dut)
    for port in (ports.net_actuation(), ports.net_actuation(instance), ports.contact_results()):
        assert port.get_system() is dut
    assert ports.valid(plant.get_reaction_forces_output_port()) is dut.port("reaction_forces")
    assert ports.valid(plant.get_state_output_port()).get_system() is plant


@pytest.mark.parametrize("step", [1e-6, 0.0005, 0.001, 0.003, 0.1])
def test_a_plant_that_holds_the_state_knows_the_step_to_the_bit(step):
    assert holds_state(MultibodyPlant(held(step)))
    assert physics_step(MultibodyPlant(held(step))) == step
    assert not holds_state(MultibodyPlant(step))
    assert physics_step(MultibodyPlant(step)) == step
    assert physics_step(MultibodyPlant(0.0)) == 0.0
