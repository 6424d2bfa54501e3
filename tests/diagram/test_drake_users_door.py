"""A Drake user's way in: the diagram in her own Simulator, vector ports, and systems of her own in the diagram."""

import numpy as np
import pytest
from conftest import ARM, ROVER
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.analysis import Simulator
from pydrake.systems.controllers import InverseDynamicsController, PidController
from pydrake.systems.framework import LeafSystem
from pydrake.systems.primitives import ConstantVectorSource, ZeroOrderHold

from drake_twin import InputError, Robot, RunError, TwinBuilder

PENDULUM = """<robot name="pendulum"><link name="world"/><link name="bob">
<inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hinge" type="continuous"><parent link="world"/><child link="bob"/><axis xyz="0 1 0"/>
<limit effort="100" velocity="100"/></joint>
<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
<joint name="hinge"><command_interface name="velocity"/><state_interface name="position"/></joint></ros2_control>
</robot>"""
TARGET = 0.7  # rad
VECTOR = "drake_twin/VectorCommandController"


@pytest.fixture
def pendulum(tmp_path):
    file = tmp_path / "pendulum.urdf"
    file.write_text(PENDULUM)
    return file


def driven(file, extension=None):
    builder = TwinBuilder().robot("p", file).controller("p", "torque", VECTOR, {"joints": ["hinge"]})
    return builder if extension is None else builder.system(extension)


def inverse_dynamics(file):
    """Connects Drake's InverseDynamicsController, whose model is parsed by Drake itself."""

    def extend(builder, parts):
        plant = MultibodyPlant(0.0)
        Parser(plant).AddModels(str(file))
        plant.AddJointActuator("motor", plant.GetJointByName("hinge"))
        plant.Finalize()
        mover = builder.AddNamedSystem("mover", InverseDynamicsController(plant, [100.0], [0.0], [20.0], False))
        target = builder.AddNamedSystem("target", ConstantVectorSource([TARGET, 0.0]))
        builder.Connect(parts.output("p", "state_estimated"), mover.get_input_port_estimated_state())
        builder.Connect(target.get_output_port(), mover.get_input_port_desired_state())
        builder.Connect(mover.get_output_port_control(), parts.input("p", "torque/command"))

    return extend


def test_her_inverse_dynamics_controller_brings_the_joint_where_it_should_be(pendulum):
    twin = driven(pendulum, inverse_dynamics(pendulum)).build()
    twin.advance_to(3.0)
    (position,) = twin.robot_state("p").positions
    assert position == pytest.approx(TARGET, abs=1e-3)
    torque = twin.diagram.GetOutputPort("p/net_actuation").Eval(twin.context)
    assert torque == pytest.approx([2 * 9.81 * 0.5 * np.sin(TARGET)], rel=1e-3)  # what holds the bob there


def test_without_a_value_nothing_is_written_and_the_joint_swings_as_a_free_one(pendulum):
    twin = driven(pendulum).build()
    twin.entities.set_joint_positions("p", {"hinge": 0.1})
    twin.advance_to(0.001)
    (velocity,) = twin.robot_state("p").velocities
    inertia = 0.01 + 2 * 0.5**2
    assert velocity == pytest.approx(-2 * 9.81 * 0.5 * np.sin(0.1) / inertia * 0.001, rel=1e-2)


def test_a_value_that_is_fixed_on_the_root_diagrams_port_is_written(pendulum):
    twin = driven(pendulum).build()
    twin.diagram.GetInputPort("p/torque/command").FixValue(twin.context, [0.5])
    twin.advance_to(0.001)
    (velocity,) = twin.robot_state("p").velocities
    assert velocity == pytest.approx(0.5 / (0.01 + 2 * 0.5**2) * 0.001, rel=1e-3)


def test_the_vector_ports_of_a_robot_are_its_state():
    twin = TwinBuilder().robot("r", ROVER, xyz=(1, 2, 0.13)).build()
    twin.publish("/r/forward_velocity_controller/commands", [1.0, 2.0, 3.0, 4.0])
    twin.advance_to(0.5)
    state = twin.robot_state("r")
    estimated = twin.diagram.GetOutputPort("r/state_estimated").Eval(twin.context)
    assert estimated.tolist() == [*state.positions, *state.velocities]
    whole = twin.diagram.GetOutputPort("r/state").Eval(twin.context)
    assert len(whole) == 7 + 6 + len(estimated)
    assert whole[4:7].tolist() == list(state.base_pose[:3])


@pytest.mark.one_plant
@pytest.mark.parametrize("model", [ROVER, ARM])
def test_the_diagram_runs_in_a_simulator_of_her_own(model):
    twin = TwinBuilder().robot("r", model, xyz=(0, 0, 0.13)).build()
    simulator = Simulator(twin.diagram)
    simulator.AdvanceTo(0.2)
    twin.advance_to(0.2)
    plant = twin.plant
    ours = plant.GetPositionsAndVelocities(plant.GetMyContextFromRoot(twin.context))
    hers = plant.GetPositionsAndVelocities(plant.GetMyContextFromRoot(simulator.get_context()))
    assert hers == pytest.approx(ours, abs=1e-9)


def test_controllers_that_are_active_at_the_start_are_active_in_a_simulator_of_her_own(tmp_path):
    (tmp_path / "c.yaml").write_text(
        "controller_manager: {ros__parameters: {arm: {type: joint_trajectory_controller/JointTrajectoryController}}}\n"
        "arm: {ros__parameters: {joints: [joint_1], command_interfaces: [velocity],"
        " state_interfaces: [position, velocity],"
        " gains: {joint_1: {p: 5.0}}}}\n"
    )
    twin = TwinBuilder().robot("a", ARM, controllers=tmp_path / "c.yaml").build()
    simulator = Simulator(twin.diagram)
    simulator.AdvanceTo(0.05)
    controller = twin.diagram.GetSubsystemByName("a").GetSubsystemByName("arm")
    sample = controller.sample(controller.GetMyContextFromRoot(simulator.get_context()))
    assert sample.active
    assert sample.memory.is_holding


class Counter(LeafSystem):
    """Counts steps of 10 ms in its discrete state."""

    def __init__(self):
        super().__init__()
        state = self.DeclareDiscreteState(1)
        self.DeclareStateOutputPort("count", state)
        self.DeclarePeriodicDiscreteUpdateEvent(0.01, 0.0, self._count)

    def _count(self, context, state):
        state.set_value(context.get_discrete_state_vector().value() + 1)


def count_of(twin):
    (count,) = (
        twin.diagram.GetSubsystemByName("counter")
        .GetOutputPort("count")
        .Eval(twin.diagram.GetSubsystemByName("counter").GetMyContextFromRoot(twin.context))
    )
    return count


def counting():
    return TwinBuilder().robot("r", ROVER, xyz=(0, 0, 0.13)).system(lambda b, p: b.AddNamedSystem("counter", Counter()))


def test_her_systems_state_is_in_the_snapshot_and_survives_a_spawn(tmp_path):
    twin = counting().build()
    twin.advance_to(0.5)
    assert count_of(twin) == 50
    twin.snapshot().save(tmp_path / "state.json")
    before = twin.state_sha256()
    twin.entities.spawn(Robot("second", ROVER, xyz=(0, 2, 0.13)))
    assert count_of(twin) == 50
    twin.advance_to(0.6)
    assert count_of(twin) == 60
    assert twin.state_sha256() != before

    from drake_twin import Snapshot

    other = counting().build()
    other.restore(Snapshot.load(tmp_path / "state.json"))
    assert (count_of(other), other.state_sha256()) == (50, before)


def test_a_port_that_there_is_not_is_named_with_those_there_are(pendulum):
    def extend(builder, parts):
        parts.input("p", "torqe/command")

    with pytest.raises(InputError, match=r"robot 'p' has no input port 'torqe/command'.*Did you mean 'torque/command'"):
        driven(pendulum, extend).build()
    with pytest.raises(InputError, match=r"unknown robot 'q'.*Valid: p"):
        driven(pendulum, lambda builder, parts: parts.output("q", "state_estimated")).build()
    with pytest.raises(InputError, match=r"no output port 'odometry'.*Valid: state, .*state_estimated"):
        driven(pendulum, lambda builder, parts: parts.output("p", "odometry")).build()


def test_a_pid_of_hers_on_the_joint_states_closes_no_algebraic_loop(pendulum):
    def extend(builder, parts):
        pid = builder.AddNamedSystem("pid", PidController([50.0], [40.0], [10.0]))
        target = builder.AddNamedSystem("target", ConstantVectorSource([TARGET, 0.0]))
        builder.Connect(parts.output("p", "state_estimated"), pid.get_input_port_estimated_state())
        builder.Connect(target.get_output_port(), pid.get_input_port_desired_state())
        builder.Connect(pid.get_output_port_control(), parts.input("p", "torque/command"))

    twin = driven(pendulum, extend).build()
    twin.advance_to(8.0)
    assert twin.robot_state("p").positions == pytest.approx((TARGET,), abs=2e-3)


class Sick(LeafSystem):
    """Writes no torque, until from a time on it raises an error or writes what is not a number."""

    def __init__(self, since, what):
        super().__init__()
        self._since, self._what = since, what
        self.DeclareVectorOutputPort("torque", 1, self._calc)

    def _calc(self, context, output):
        output.SetFromVector([self._what() if context.get_time() >= self._since else 0.0])


@pytest.mark.parametrize("what", [lambda: {}[7], lambda: float("nan")])
def test_an_error_in_her_system_leaves_the_twin_in_its_last_good_state(pendulum, what):
    def extend(builder, parts):
        builder.Connect(builder.AddSystem(Sick(0.1, what)).get_output_port(), parts.input("p", "torque/command"))

    twin = driven(pendulum, extend).build()
    twin.advance_to(0.05)
    with pytest.raises(RunError, match=r"KeyError: 7|efforts on its port command are \[nan\]"):
        twin.advance_to(0.3)
    assert twin.time == pytest.approx(twin.context.get_time(), abs=2e-3)
    assert 0.09 < twin.time <= 0.11
    with pytest.raises(RunError):
        twin.advance_to(0.4)


def test_a_system_without_a_name_gets_one_that_is_the_same_in_each_process(pendulum):
    def extend(builder, parts):
        hold = builder.AddSystem(ZeroOrderHold(0.01, 1))
        builder.Connect(builder.AddSystem(ConstantVectorSource([0.3])).get_output_port(), hold.get_input_port())
        builder.Connect(hold.get_output_port(), parts.input("p", "torque/command"))

    one, other = (driven(pendulum, extend).build() for _ in range(2))
    one.advance_to(0.2)
    assert list(one.snapshot().systems) == ["ZeroOrderHold_0"]
    other.restore(one.snapshot())
    assert other.state_sha256() == one.state_sha256()
