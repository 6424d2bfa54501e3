import numpy as np
import pytest
from pydrake.common.value import AbstractValue

from drake_twin import messages
from drake_twin.errors import CommandError
from drake_twin.systems.velocity_controller import VelocityController


def make_dut():
    return VelocityController(["left", "right", "arm"], [-1.0, -2.0, -np.inf], [1.0, 2.0, np.inf])


def evaluate(dut, message):
    context = dut.CreateDefaultContext()
    dut.get_commands_input_port().FixValue(context, AbstractValue.Make(message))
    return dut.get_velocity_commands_output_port().Eval(context)


def test_nothing_is_written_before_the_first_message():
    assert np.isnan(evaluate(make_dut(), None)).all()


def test_a_command_is_forwarded_in_the_order_of_the_joints():
    assert evaluate(make_dut(), messages.float64_multi_array([0.5, -1.5, 40.0])).tolist() == [0.5, -1.5, 40.0]


def test_a_command_beyond_the_limits_is_clamped_to_them():
    assert evaluate(make_dut(), messages.float64_multi_array([7.0, -7.0, -7.0])).tolist() == [1.0, -2.0, -7.0]


def test_a_command_of_the_wrong_size_says_what_was_expected_and_what_came():
    with pytest.raises(CommandError, match=r"the command has 2 elements, but there are 3 joints: left, right, arm"):
        evaluate(make_dut(), messages.float64_multi_array([1.0, 2.0]))


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_command_that_is_not_finite_never_gets_through(bad):
    with pytest.raises(CommandError, match=r"the command for joint right is -?(nan|inf), which is not a finite number"):
        evaluate(make_dut(), messages.float64_multi_array([1.0, bad, 1.0]))


def test_limits_that_do_not_match_the_joints_are_refused():
    with pytest.raises(ValueError, match="2 joints, but 1 lower and 2 upper limits"):
        VelocityController(["a", "b"], [0.0], [1.0, 1.0])


def test_a_command_is_computed_once_and_not_at_every_evaluation():
    class Counting(VelocityController):
        calls = 0

        def check_command(self, message):
            Counting.calls += 1
            return super().check_command(message)

    dut = Counting(["wheel"], [-1.0], [1.0])
    context = dut.CreateDefaultContext()
    dut.get_commands_input_port().FixValue(context, AbstractValue.Make(messages.float64_multi_array([0.5])))
    for step in range(100):
        context.SetTime(0.001 * step)
        dut.get_velocity_commands_output_port().Eval(context)
    assert Counting.calls == 1
