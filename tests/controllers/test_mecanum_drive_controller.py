from math import cos, nan, sin

import numpy as np
import pytest
from drive_harness import Driven

from drake_twin.controllers.base_controller import Upstream
from drake_twin.controllers.mecanum_drive_controller import MecanumDriveController
from drake_twin.errors import CommandError, InputError

KIND = "mecanum_drive_controller/MecanumDriveController"
WHEELS = {
    "front_left_wheel_command_joint_name": "fl",
    "front_right_wheel_command_joint_name": "fr",
    "rear_right_wheel_command_joint_name": "rr",
    "rear_left_wheel_command_joint_name": "rl",
    "kinematics": {"wheels_radius": 0.1, "sum_of_robot_center_projection_on_X_Y_axis": 0.5},
    "reference_timeout": 1.0,
}


def drive(parameters=None, **setup):
    return Driven(KIND, WHEELS | (parameters or {}), **setup)


def test_the_claims_are_front_left_front_right_rear_right_rear_left():
    assert list(map(str, drive().controller.claims)) == ["fl/velocity", "fr/velocity", "rr/velocity", "rl/velocity"]


def test_before_the_first_message_the_wheels_are_held_at_zero():
    dut = drive()
    dut.advance(0.005)
    assert dut.commands == [0.0] * 4


@pytest.mark.parametrize(
    ("command", "wheels"),
    [
        ({"x": 0.2}, [2.0, 2.0, 2.0, 2.0]),
        ({"y": 0.2}, [-2.0, 2.0, -2.0, 2.0]),
        ({"z": 1.0}, [-5.0, 5.0, 5.0, -5.0]),
    ],
)
def test_a_command_turns_the_wheels(command, wheels):
    dut = drive()
    dut.send(**command)
    dut.advance(0.005)
    assert dut.commands == pytest.approx(wheels)


def test_mecanum_timeout_stops():
    dut = drive()
    dut.send(x=0.2)
    dut.advance(1.005)
    assert dut.commands == pytest.approx([2.0] * 4)
    dut.advance(1.015)
    assert dut.commands == [0.0] * 4


def test_a_timeout_of_zero_uses_a_command_up_in_one_update():
    dut = drive({"reference_timeout": 0.0})
    dut.send(x=0.2)
    dut.advance(0.005)
    assert dut.commands == pytest.approx([2.0] * 4)
    dut.advance(0.015)
    assert dut.commands == [0.0] * 4
    dut.send(x=0.2)
    dut.advance(0.025)
    assert dut.commands == pytest.approx([2.0] * 4)


def test_a_command_used_up_is_used_up_in_a_copy_of_the_context_too():
    dut, copy = drive({"reference_timeout": 0.0}), drive({"reference_timeout": 0.0})
    dut.send(x=0.2)
    dut.advance(0.005)
    copy.send(x=0.2)
    copy.root.SetTimeStateAndParametersFrom(dut.root)
    copy.simulator.Initialize()
    copy.advance(0.015)
    assert copy.commands == [0.0] * 4


def test_a_nan_element_stops_and_an_infinite_one_is_refused():
    dut = drive()
    dut.send(x=0.2)
    dut.advance(0.005)
    with pytest.raises(CommandError, match=r"the command's linear.y is inf, which is not a finite number"):
        dut.send(y=np.inf)
    dut.send(x=nan)
    dut.advance(0.015)
    assert dut.commands == [0.0] * 4


def test_limits_hold_for_each_direction():
    dut = drive({"linear": {"x": {"max_velocity": 0.1}, "y": {"max_acceleration": 1.0}}, "angular.z.max_velocity": 0.0})
    dut.send(x=9.0, y=9.0, z=9.0)
    dut.advance(0.005)
    assert dut.commands == pytest.approx([(0.1 - 0.01) / 0.1, (0.1 + 0.01) / 0.1] * 2)


def test_odometry_follows_a_motion_in_all_directions():
    dut = drive()
    dut.commands_while(2.0, x=0.3, y=-0.2, z=0.5)
    x, y, heading, *velocity = dut.odometry
    assert velocity == pytest.approx([0.3, -0.2, 0.5])
    assert heading == pytest.approx(0.5 * 1.99, abs=0.006)
    # The analytic solution for the heading reached, which upstream's Euler steps of 10 ms come near.
    expected = np.array([[sin(heading), cos(heading) - 1], [1 - cos(heading), sin(heading)]]) @ [0.3, -0.2] / 0.5
    assert (x, y) == pytest.approx(expected, abs=0.01 * 0.5)


def test_odometry_state_and_transform_are_published_at_every_update():
    dut = drive({"kinematics": WHEELS["kinematics"] | {"base_frame_offset": {"x": 0.1, "y": 0.2, "theta": 0.3}}})
    dut.commands_while(0.2, x=0.3, y=-0.2, z=0.5)
    odom, (transform,) = dut.message("odometry"), dut.message("tf_odometry").transforms
    assert odom.header == transform.header
    assert odom.pose.pose.orientation == transform.transform.rotation
    assert odom.header.stamp.nanosec == 190_000_000
    assert odom.pose.covariance[0] == 0.1
    assert dut.odometry[3:] == pytest.approx([0.3, -0.2, 0.5])
    state = dut.message("controller_state")
    assert state.reference_velocity.linear.y == -0.2
    assert [
        state.front_left_wheel_velocity,
        state.front_right_wheel_velocity,
        state.back_right_wheel_velocity,
        state.back_left_wheel_velocity,
    ] == pytest.approx(dut.commands)


def test_chained_references():
    names = MecanumDriveController.reference_interfaces(None, None)
    assert list(map(str, names)) == ["linear/x/velocity", "linear/y/velocity", "angular/z/velocity"]
    dut = drive(upstream={"above": Upstream(3, (0, 1, 2))})
    dut.controller.GetInputPort("above").FixValue(dut.context, [0.0, 0.2, 0.0])
    dut.advance(0.005)
    assert dut.commands == pytest.approx([-2.0, 2.0, -2.0, 2.0])


def test_a_missing_wheel_is_refused():
    with pytest.raises(InputError, match="the parameter 'rear_left_wheel_command_joint_name' is missing"):
        Driven(KIND, {name: value for name, value in WHEELS.items() if "rear_left" not in name})
    with pytest.raises(InputError, match="rear_left_wheel_command_joint_name is empty"):
        drive({"rear_left_wheel_command_joint_name": ""})


HUSARION = {
    "front_left_wheel_name": "fl",
    "front_right_wheel_name": "fr",
    "rear_left_wheel_name": "rl",
    "rear_right_wheel_name": "rr",
    "wheel_separation_x": 0.4,
    "wheel_separation_y": 0.5,
    "wheel_radius": 0.08,
    "wheel_separation_y_multiplier": 1.2,
    "wheel_radius_multiplier": 1.25,
}


def test_the_parameters_of_husarions_fork_mean_the_same_robot():
    dut, upstream = Driven(KIND, HUSARION), drive()  # half of 0.4 + 1.2 · 0.5, and 1.25 · 0.08
    assert dut.warnings == ()
    assert list(dut.controller.subscribed) == ["cmd_vel"]
    assert "odom" in dut.controller.published
    assert dut.controller.claims == upstream.controller.claims
    for each in (dut, upstream):
        each.send(x=0.2, y=-0.1, z=0.7)
        each.advance(0.005)
    assert dut.commands == pytest.approx(upstream.commands)
    dut.advance(0.515)  # its own default timeout
    assert dut.commands == [0.0] * 4


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"wheel_separation_x": "wide"}, "'wide' is not a number"),
        ({"wheel_radius": 0}, "0.0 is not above 0"),
        ({"rear_left_wheel_name": ""}, "rear_left_wheel_name is empty"),
    ],
)
def test_a_mistake_in_husarions_names_is_told_in_those_names(parameters, message):
    with pytest.raises(InputError, match=message):
        Driven(KIND, HUSARION | parameters)
    with pytest.raises(InputError, match="'wheel_separation_y' is missing"):
        Driven(KIND, {name: value for name, value in HUSARION.items() if name != "wheel_separation_y"})


@pytest.mark.parametrize(
    ("parameters", "frames"),
    [  # test_mecanum_drive_controller.cpp:175-300
        ({"tf_frame_prefix": "test_prefix"}, ("test_prefix/odom", "test_prefix/base_link")),
        ({}, ("test_namespace/odom", "test_namespace/base_link")),
        ({"tf_frame_prefix_enable": False, "tf_frame_prefix": "test_prefix"}, ("odom", "base_link")),
    ],
)
def test_the_prefix_goes_before_both_frames(parameters, frames):
    dut = drive({**parameters, "odom_frame_id": "odom", "base_frame_id": "base_link"}, namespace="/test_namespace")
    dut.advance(0.015)
    odometry = dut.message("odometry")
    assert (odometry.header.frame_id, odometry.child_frame_id) == frames
