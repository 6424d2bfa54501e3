from dataclasses import replace
from math import exp, isnan, pi

import numpy as np
import pytest
from device_harness import ROBOT, Running, setup_of
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.multibody.tree import PrismaticJoint, SpatialInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder, LeafSystem

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup, Upstream
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.pid_controller import PidController, PidControllerGains, PidControllerParameters
from drake_twin.errors import CommandError, InputError
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.systems.no_message import empty_value, make_value

POSITION = ("position",)
BOTH = ("position", "velocity")


def pid(gains=(), interfaces=POSITION, state=(0.2, 1.0, 0.0, 0.0), dofs=("finger",), upstream=None, **parameters):
    gains = dict(zip(dofs, gains, strict=False))
    parameters = PidControllerParameters(dofs, "effort", interfaces, gains=gains, **parameters)
    ports = {} if upstream is None else {"above": [float("nan")] * len(interfaces) * len(dofs)}
    return Running(
        PidController(setup_of(PidController, parameters, upstream=upstream or {})), state=list(state), **ports
    )


def reference(values, values_dot=(), names=()):
    return messages.MultiDOFCommand(
        dof_names=list(names), values=np.array(values, dtype=float), values_dot=np.array(values_dot, dtype=float)
    )


def test_it_claims_the_command_interfaces_and_exports_a_reference_for_each_interface_and_dof():
    parameters = PidControllerParameters(
        ("finger", "thumb"), "effort", BOTH, reference_and_state_dof_names=("thumb", "finger")
    )
    assert PidController.claimed_interfaces(parameters, ROBOT) == (
        Interface("finger", "effort"),
        Interface("thumb", "effort"),
    )
    assert list(map(str, PidController.reference_interfaces(parameters, ROBOT))) == [
        "thumb/position",
        "finger/position",
        "thumb/velocity",
        "finger/velocity",
    ]


def test_the_state_at_activation_is_the_first_reference():
    run = pid([PidControllerGains(p=10.0)])
    run.fix("state", [0.3, 0.0, 0.0, 0.0])
    run.advance(0.02)
    assert run.commands() == [pytest.approx(-1.0)]


def test_without_a_first_reference_nothing_is_written_until_a_message_comes():
    run = pid([PidControllerGains(p=10.0)], set_current_state_as_first_setpoint=False)
    run.advance(0.02)
    assert isnan(run.commands()[0])
    run.send("reference", reference([0.5]))
    run.advance(0.04)
    assert run.commands() == [pytest.approx(3.0)]


def test_two_interfaces_give_the_derivative_of_the_error():
    run = pid([PidControllerGains(p=10.0, d=2.0)], BOTH, state=(0.2, 0.0, 0.5, 0.0))
    run.send("reference", reference([0.6], [1.5]))
    run.advance(0.02)
    assert run.commands() == [pytest.approx(10.0 * 0.4 + 2.0 * (1.5 - 0.5))]


def test_feedforward_is_of_the_reference_or_of_its_derivative_and_has_to_be_enabled():
    gains = [PidControllerGains(feedforward_gain=3.0)]
    for interfaces, enabled, expected in ((POSITION, True, 1.8), (BOTH, True, 4.5), (BOTH, False, 0.0)):
        run = pid(gains, interfaces, enable_feedforward=enabled)
        run.send("reference", reference([0.6], [1.5]))
        run.advance(0.02)
        assert run.commands() == [pytest.approx(expected)]


def test_a_continuous_angle_goes_the_short_way_round():
    for wraps, error in ((True, 2 * pi - 6.0), (False, -6.0)):
        run = pid([PidControllerGains(p=1.0, angle_wraparound=wraps)], dofs=("thumb",), state=(0.0, 3.0, 0.0, 0.0))
        run.send("reference", reference([-3.0]))
        run.advance(0.02)
        assert run.commands() == [pytest.approx(error)]


def test_elements_of_a_reference_go_by_their_names():
    run = pid([PidControllerGains(p=1.0)] * 2, dofs=("finger", "thumb"), state=(0.0, 0.0, 0.0, 0.0))
    run.send("reference", reference([1.0, 2.0], names=["thumb", "finger"]))
    run.advance(0.02)
    assert run.commands() == [2.0, 1.0]


def test_an_element_that_is_nan_leaves_its_reference_as_it_was():
    run = pid([PidControllerGains(p=1.0)] * 2, dofs=("finger", "thumb"), state=(0.0, 0.0, 0.0, 0.0))
    run.send("reference", reference([1.0, 2.0]))
    run.advance(0.02)
    run.send("reference", reference([float("nan"), 5.0]))
    run.advance(0.04)
    assert run.commands() == [1.0, 5.0]


def test_a_derivative_without_its_value_changes_nothing():
    run = pid([PidControllerGains(d=1.0)], BOTH, state=(0.0, 0.0, 0.0, 0.0))
    run.send("reference", reference([float("nan")], [5.0]))
    run.advance(0.02)
    assert run.commands() == [0.0]


@pytest.mark.parametrize(
    ("message", "text"),
    [
        (([1.0, 2.0], [], []), "0 names, 2 values and 1 derivatives, but there are 1 degrees of freedom: finger"),
        (([1.0], [], ["elbow"]), "the reference lacks 'finger'; it has elbow"),
    ],
)
def test_a_reference_of_another_size_or_name_is_refused(message, text):
    run = pid()
    with pytest.raises(CommandError, match=text):
        run.send("reference", reference(*message))


def test_a_controller_above_writes_the_references_and_messages_are_ignored_meanwhile():
    run = pid(
        [PidControllerGains(p=1.0, d=1.0)], BOTH, state=(0.0, 0.0, 0.0, 0.0), upstream={"above": Upstream(2, (0, 1))}
    )
    run.send("reference", reference([7.0], [0.0]))
    run.fix("above", [2.0, 0.5])
    run.advance(0.02)
    assert run.commands() == [2.5]
    run.fix("above", [float("nan")] * 2)
    run.advance(0.04)
    assert run.commands() == [2.5]
    run.send("reference", reference([7.0], [0.0]))
    run.advance(0.06)
    assert run.commands() == [7.0]


def test_controller_state_tells_what_the_last_update_did():
    run = pid([PidControllerGains(p=10.0)], BOTH, state=(0.2, 0.0, 0.5, 0.0))
    run.send("reference", reference([0.6], [1.5]))
    run.advance(0.025)
    message = run.output("controller_state")
    (state,) = message.dof_states
    assert message.header.stamp.nanosec == 20_000_000
    assert (state.name, state.reference, state.feedback, state.feedback_dot) == ("finger", 0.6, 0.2, 0.5)
    assert (state.error, state.error_dot, state.output) == pytest.approx((0.4, 1.0, 4.0))
    assert state.time_step == pytest.approx(0.01)
    store = messages.type_store()
    assert store.serialize_cdr(message, "control_msgs/msg/MultiDOFStateStamped")
    run.controller.deactivate(run.context)
    assert run.output("controller_state") is None


def test_the_integral_term_outlives_a_deactivation_unless_parameters_say_no():
    for saved, expected in ((True, 0.4), (False, 0.0)):
        run = pid([PidControllerGains(i=1.0, save_i_term=saved)], state=(0.0, 0.0, 0.0, 0.0))
        run.send("reference", reference([1.0]))
        run.advance(0.4)
        assert run.commands() == [pytest.approx(0.4)]
        run.controller.deactivate(run.context)
        assert isnan(run.commands()[0])
        run.fix("reference", None)
        run.controller.activate(run.context)
        run.advance(0.5)
        assert run.commands() == [pytest.approx(expected)]


def test_parameters_that_do_not_fit_together_are_refused():
    parameters = PidControllerParameters(("finger",), "effort", POSITION)
    setup = setup_of(PidController, parameters)
    wrong = replace(parameters, reference_and_state_dof_names=("finger", "thumb"))
    with pytest.raises(InputError, match="'dut': dof_names has 1 elements and reference_and_state_dof_names has 2"):
        PidController(replace(setup, parameters=wrong))
    wrong = replace(parameters, reference_and_state_interfaces=())
    with pytest.raises(InputError, match="one or two are needed"):
        PidController(replace(setup, parameters=wrong))


class Effort(LeafSystem):
    """Nothing where nothing is written, as a joint's servo has it."""

    def __init__(self):
        super().__init__()
        self.DeclareVectorInputPort("command", 1)
        self.DeclareVectorOutputPort("effort", 1, self._calc)

    def _calc(self, context, output):
        output.SetFromVector(np.nan_to_num(self.get_input_port().Eval(context)))


def test_a_mass_on_a_critically_damped_pid_follows_the_closed_form():
    omega, mass = 8.0, 2.0
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=1e-3)
    plant.SetUseSampledOutputPorts(False)
    body = plant.AddRigidBody("mass", SpatialInertia.SolidSphereWithMass(mass, 0.1))
    joint = plant.AddJoint(PrismaticJoint("slide", plant.world_frame(), body.body_frame(), np.array([1.0, 0.0, 0.0])))
    plant.AddJointActuator("slide", joint)
    plant.Finalize()
    gains = PidControllerGains(p=mass * omega**2, d=2 * mass * omega)
    parameters = PidControllerParameters(("slide",), "effort", BOTH, gains={"slide": gains})
    layout = StateLayout(2, {"slide": 0}, {"slide": 1}, {"slide": 0}, num_actuators=1)
    claims = PidController.claimed_interfaces(parameters, ROBOT)
    controller = builder.AddNamedSystem(
        "pid", PidController(ControllerSetup("pid", parameters, claims, ROBOT, layout, update_period=1e-3))
    )
    builder.Connect(plant.get_state_output_port(), controller.get_state_input_port())
    effort = builder.AddSystem(Effort())
    builder.Connect(controller.get_command_interfaces_output_port(), effort.get_input_port())
    builder.Connect(effort.get_output_port(), plant.get_actuation_input_port())
    builder.ExportInput(controller.get_reference_input_port(), "reference")
    diagram = builder.Build()
    simulator = Simulator(diagram)
    root = simulator.get_mutable_context()
    context = controller.GetMyMutableContextFromRoot(root)
    diagram.GetInputPort("reference").FixValue(root, empty_value())
    controller.activate(context)
    value = controller.read("reference", reference([1.0], [0.0]), context)
    diagram.GetInputPort("reference").FixValue(root, make_value(value))
    for time in (0.1, 0.2, 0.4, 1.0):
        simulator.AdvanceTo(time)
        expected = 1.0 - (1.0 + omega * time) * exp(-omega * time)
        assert plant.GetPositions(plant.GetMyContextFromRoot(root))[0] == pytest.approx(expected, abs=0.006)
