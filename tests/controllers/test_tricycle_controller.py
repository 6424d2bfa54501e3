from math import atan, cos, pi

import numpy as np
import pytest
from drive_harness import Driven

from drake_twin.errors import CommandError, InputError

KIND = "tricycle_controller/TricycleController"
WHEEL = {"traction_joint_name": "traction", "steering_joint_name": "steering", "wheelbase": 1.7, "wheel_radius": 0.3}


def drive(parameters=None, **setup):
    return Driven(KIND, WHEEL | (parameters or {}), **setup)


def test_the_claims_are_the_wheels_velocity_and_the_steering_joints_position():
    assert list(map(str, drive().controller.claims)) == ["traction/velocity", "steering/position"]


def test_before_the_first_message_wheel_and_angle_are_zero():
    dut = drive()
    dut.advance(0.005)
    assert dut.commands == [0.0, 0.0]


def test_a_command_is_reached_and_its_circle_reckoned():
    dut = drive({"velocity_rolling_window_size": 1})
    dut.commands_while(4.0, x=0.5, z=0.25)
    angle = atan(0.25 * 1.7 / 0.5)
    assert dut.commands == pytest.approx([0.5 / (0.3 * cos(angle)), angle])
    x, y, heading, linear, _, angular = dut.odometry
    assert (linear, angular) == pytest.approx((0.5, 0.25))
    assert (x, y) == pytest.approx((2 * np.sin(heading), 2 * (1 - np.cos(heading))), abs=0.01)


def test_the_wheel_turns_slower_while_its_angle_is_off():
    dut = drive()
    dut.send(z=0.3)  # a turn on the spot: the wheel must stand across
    dut.advance(0.0005)
    assert dut.commands == pytest.approx([0.3 * 1.7 / 0.3 * cos(pi / 2), pi / 2])
    dut.advance(0.015)
    assert dut.commands == pytest.approx([0.3 * 1.7 / 0.3, pi / 2])


def test_tricycle_timeout_is_in_milliseconds_and_brakes_within_the_limits():
    dut = drive({"cmd_vel_timeout": 300, "traction": {"max_deceleration": 8.0}})
    dut.send(x=0.3)
    dut.advance(0.305)
    assert dut.commands[0] == pytest.approx(1.0)
    dut.advance(0.315)
    assert dut.commands[0] == pytest.approx(1.0 - 0.08)


def test_limits_make_the_ramps_they_describe():
    dut = drive({"traction": {"max_acceleration": 5.0}, "steering": {"max_velocity": 1.0, "max_position": 0.02}})
    commands = dut.commands_while(0.04, x=0.5, z=0.25)
    np.testing.assert_allclose(commands[:, 0], [0.05, 0.1, 0.15, 0.2])
    np.testing.assert_allclose(commands[:, 1], [0.01, 0.02, 0.02, 0.02])


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_nan_or_infinite_element_is_refused(bad):
    with pytest.raises(CommandError, match=r"the command's linear.x is (nan|inf), which is not a finite number"):
        drive().send(x=bad)


def test_the_transform_is_off_by_default_and_the_pose_can_be_left_out():
    dut = drive({"odom_only_twist": True})
    assert set(dut.controller.published) == {"odom"}
    dut.commands_while(1.0, x=0.5, z=0.25)
    assert dut.odometry[:3].tolist() == [0.0, 0.0, 0.0]
    assert dut.odometry[3] > 0.4


def test_what_is_written_is_published_as_an_ackermann_command():
    dut = drive({"publish_ackermann_command": True})
    dut.commands_while(0.1, x=0.5, z=0.25)
    message = dut.message("cmd_ackermann")
    assert [message.speed, message.steering_angle] == dut.commands


@pytest.mark.parametrize(
    ("parameters", "text"),
    [
        ({"traction": {"max_jerk": -1.0}}, "a limit of jerk is negative"),
        ({"steering": {"max_position": 1.0, "min_position": 2.0}}, "the position limits are in the wrong order"),
        ({"cmd_vel_timeout": 0.5}, "0.5 is not a whole number"),
        ({"steering_joint_name": ""}, "steering_joint_name is empty"),
    ],
)
def test_parameters_that_cannot_be_are_refused(parameters, text):
    with pytest.raises(InputError, match=text):
        drive(parameters)


def test_deactivation_leaves_both_joints_commanded_to_zero():
    dut = drive()  # test_tricycle_controller.cpp:366-370
    dut.send(x=0.3, z=0.1)
    dut.advance(0.015)
    assert np.all(dut.commands)
    dut.controller.deactivate(dut.context)
    assert dut.commands == [0.0, 0.0]
