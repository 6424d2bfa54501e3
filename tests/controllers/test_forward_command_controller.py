import numpy as np
import pytest

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.effort_controllers import JointGroupEffortController
from drake_twin.controllers.forward_command_controller import (
    ForwardCommandController,
    ForwardCommandParameters,
    MultiInterfaceForwardCommandController,
    MultiInterfaceForwardCommandParameters,
)
from drake_twin.controllers.joint_group_controller import JointGroupParameters
from drake_twin.controllers.position_controllers import JointGroupPositionController
from drake_twin.controllers.velocity_controllers import JointGroupVelocityController
from drake_twin.description.robot_description import Joint, RobotDescription
from drake_twin.errors import CommandError
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.systems.no_message import empty_value, make_value

ROBOT = RobotDescription("robot", ("base", "link"), (Joint("left", "continuous", "base", "link"),))


def make_dut(kind=ForwardCommandController, parameters=None):
    parameters = parameters or ForwardCommandParameters(("left", "right", "arm"), "velocity")
    claims = kind.claimed_interfaces(parameters, ROBOT)
    return kind(ControllerSetup("dut", parameters, claims, ROBOT, StateLayout(0, {}, {}, {})))


def publish(dut, context, data):
    value = dut.read("commands", messages.float64_multi_array(data), context)
    dut.get_commands_input_port().FixValue(context, make_value(value))


def evaluate(dut, data):
    context = dut.CreateDefaultContext()
    if data is None:
        dut.get_commands_input_port().FixValue(context, empty_value())
    else:
        publish(dut, context, data)
    return dut.get_command_interfaces_output_port().Eval(context)


def test_nothing_is_written_before_the_first_message():
    assert np.isnan(evaluate(make_dut(), None)).all()


def test_a_command_is_forwarded_in_the_order_of_the_joints():
    assert evaluate(make_dut(), [0.5, -1.5, 40.0]).tolist() == [0.5, -1.5, 40.0]


def test_a_command_of_the_wrong_size_gives_the_controller_up_and_says_what_was_expected_and_what_came():
    with pytest.raises(CommandError, match=r"has 2 elements, but there are 3 command interfaces: left/vel.*") as error:
        evaluate(make_dut(), [1.0, 2.0])
    assert error.value.deactivates


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_command_that_is_not_finite_is_dropped(bad):
    with pytest.raises(CommandError, match=r"for right/velocity is -?(nan|inf), which is not a finite number") as error:
        evaluate(make_dut(), [1.0, bad, 1.0])
    assert not error.value.deactivates


def test_a_command_is_computed_once_and_not_at_every_evaluation():
    dut = make_dut()
    context = dut.CreateDefaultContext()
    publish(dut, context, [0.5, 1, 2])
    port = dut.get_command_interfaces_output_port()
    port.Eval(context)
    cache = dut.get_cache_entry(port.cache_entry().cache_index())
    for step in range(100):
        context.SetTime(0.001 * step)
        assert not cache.is_out_of_date(context)


@pytest.mark.parametrize(
    ("kind", "interface"),
    [
        (JointGroupVelocityController, "velocity"),
        (JointGroupPositionController, "position"),
        (JointGroupEffortController, "effort"),
    ],
)
def test_a_joint_group_claims_its_interface_of_every_joint(kind, interface):
    dut = make_dut(kind, JointGroupParameters(("left", "right")))
    assert [str(claim) for claim in dut.claims] == [f"left/{interface}", f"right/{interface}"]


def test_several_interfaces_of_one_joint_take_a_message_in_their_order():
    parameters = MultiInterfaceForwardCommandParameters("left", ("position", "effort"))
    dut = make_dut(MultiInterfaceForwardCommandController, parameters)
    assert [str(claim) for claim in dut.claims] == ["left/position", "left/effort"]
    assert evaluate(dut, [0.1, 7.0]).tolist() == [0.1, 7.0]


def test_a_command_holds_as_long_as_the_parameter_command_timeout_says():
    assert make_dut().timeout("commands") is None
    parameters = ForwardCommandParameters(("left",), "velocity", command_timeout=0.5)
    assert make_dut(parameters=parameters).timeout("commands") == 0.5


def test_a_velocity_starts_or_stops_a_joint_where_it_becomes_or_ceases_to_be_zero_and_a_position_always_may():
    velocities = make_dut()
    positions = make_dut(parameters=ForwardCommandParameters(("arm",), "position"))
    assert not velocities.starts_or_stops(messages.Numbers((1.0, 2.0, 0.0)), messages.Numbers((-3.0, 1.0, 0.0)))
    assert velocities.starts_or_stops(messages.Numbers((1.0, 2.0, 0.0)), messages.Numbers((1.0, 0.0, 0.0)))
    assert velocities.starts_or_stops(messages.Numbers((1.0, 2.0, 0.0)), None)
    assert velocities.starts_or_stops(None, messages.Numbers((0.0, 0.0, 0.0)))
    assert positions.starts_or_stops(messages.Numbers((1.0,)), messages.Numbers((1.0,)))
