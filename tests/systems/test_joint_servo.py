import numpy as np

from drake_twin.systems.joint_servo import JointServo


def evaluate(dut, **commands):
    context = dut.CreateDefaultContext()
    for controller, values in commands.items():
        dut.get_controller_input_port(controller).FixValue(context, values)
    return dut.get_desired_state_output_port().Eval(context).tolist()


def test_commands_land_on_the_actuators_of_their_controllers_joints():
    dut = JointServo([0.0, 0.0, 0.0], {"wheels": [2, 0], "arm": [1]})
    assert evaluate(dut, wheels=[5.0, 6.0], arm=[7.0]) == [0, 0, 0, 6.0, 7.0, 5.0]


def test_a_claimed_joint_without_a_command_is_held_at_zero_velocity():
    dut = JointServo([0.0, 0.0], {"wheels": [0, 1]})
    assert evaluate(dut, wheels=[np.nan, np.nan]) == [0, 0, 0, 0]


def test_a_joint_that_no_controller_claims_is_held_where_it_started():
    dut = JointServo([0.3, -0.4], {"one": [1]})
    assert evaluate(dut, one=[2.0]) == [0.3, -0.4, 0.0, 2.0]


def test_a_robot_without_controllers_is_held_where_it_started():
    assert evaluate(JointServo([0.3, -0.4], {})) == [0.3, -0.4, 0.0, 0.0]
