"""Hold against ros2_controllers' test_omni_wheel_drive_controller.cpp, cited as "gtest: line"."""

from math import cos, isnan, nan, pi, sin

import numpy as np
import pytest
from drive_harness import Driven

from drake_twin.controllers.base_controller import Upstream
from drake_twin.controllers.omni_wheel_drive_controller import OmniWheelDriveController
from drake_twin.errors import CommandError, InputError

KIND = "omni_wheel_drive_controller/OmniWheelDriveController"
WHEELS = ["front_wheel_joint", "left_wheel_joint", "back_wheel_joint", "right_wheel_joint"]
FIXTURE = {"wheel_names": WHEELS, "wheel_offset": 0.0, "robot_radius": 0.5, "wheel_radius": 0.1}


def drive(parameters=None, **setup):
    return Driven(KIND, FIXTURE | (parameters or {}), **setup)


def wheels(count):
    return [f"wheel_{index + 1}" for index in range(count)]


@pytest.mark.parametrize("missing", FIXTURE)
def test_parameters_without_a_default_are_required(missing):
    with pytest.raises(InputError, match=f"the parameter '{missing}' is missing"):  # gtest: 37
        Driven(KIND, {name: value for name, value in FIXTURE.items() if name != missing})


@pytest.mark.parametrize("parameter", ["robot_radius", "wheel_radius"])
def test_a_radius_must_be_positive(parameter):
    with pytest.raises(InputError, match=r"0.0 is not above 0"):  # gt<> of the parameters' YAML
        drive({parameter: 0.0})


def test_fewer_than_three_wheels_are_refused():
    with pytest.raises(InputError, match="there are 2 wheels; at least three are needed"):  # gtest: 46
        drive({"wheel_names": ["first_wheel_joint", "second_wheel_joint"]})


def test_a_covariance_needs_six_elements():
    with pytest.raises(InputError, match="pose has 5 elements; it needs six"):
        drive({"diagonal_covariance": {"pose": [0.1] * 5}})


def test_the_interfaces_are_those_of_upstream():
    claims = drive().controller.claims
    assert len(claims) == 4  # gtest: 57
    assert list(map(str, claims)) == [f"{wheel}/velocity" for wheel in WHEELS]  # gtest: 60
    references = OmniWheelDriveController.reference_interfaces(None, None)
    assert len(references) == 3  # gtest: 76
    assert [item.joint for item in references] == ["linear/x", "linear/y", "angular/z"]  # gtest: 82
    assert list(map(str, references)) == ["linear/x/velocity", "linear/y/velocity", "angular/z/velocity"]  # gtest: 83
    assert {item.name for item in references} == {"velocity"}  # gtest: 86


@pytest.mark.parametrize(
    ("enabled", "prefix", "namespace", "before"),
    [
        (False, "test_prefix", "", ""),  # gtest: 111, 112
        (True, "test_prefix", "", "test_prefix/"),  # gtest: 138, 139
        (True, "", "", ""),  # gtest: 164, 165
        (False, "test_prefix", "/test_namespace", ""),  # gtest: 192, 193
        (True, "test_prefix", "/test_namespace", "test_prefix/"),  # gtest: 222, 223
        (True, "", "/test_namespace", "test_namespace/"),  # gtest: 251, 252
    ],
)
def test_both_frames_of_the_odometry_get_the_prefix(enabled, prefix, namespace, before):
    dut = drive({"tf_frame_prefix_enable": enabled, "tf_frame_prefix": prefix}, namespace=namespace)
    dut.advance(0.005)
    assert dut.message("odom").header.frame_id == f"{before}odom"
    assert dut.message("odom").child_frame_id == f"{before}base_link"


def test_nothing_is_written_before_the_first_command_and_zero_after_the_timeout():
    dut = drive()
    dut.advance(0.495)
    assert all(map(isnan, dut.commands))  # gtest: 381: the references, which upstream does not write (388)
    dut.advance(0.525)
    assert dut.commands == [0.0] * 4


def test_a_late_command_stops_the_wheels_and_a_timely_one_turns_them():
    dut = drive()
    dut.send(x=1.0, y=1.0, z=1.0)
    dut.advance(0.495)
    assert dut.commands == pytest.approx([-15.0, 5.0, 5.0, -15.0], abs=1e-12)
    dut.advance(0.515)
    assert dut.commands == [0.0] * 4  # gtest: 404
    dut.send(x=1.0, y=1.0, z=1.0)
    dut.advance(0.525)
    assert dut.commands == pytest.approx([-15.0, 5.0, 5.0, -15.0], abs=1e-12)  # gtest: 419


def test_a_reference_of_another_controller_turns_the_wheels():
    dut = drive(upstream={"above": Upstream(3, (0, 1, 2))})
    dut.advance(0.005)
    assert all(map(isnan, dut.commands))  # gtest: 468
    dut.controller.GetInputPort("above").FixValue(dut.context, [1.0, 1.0, 1.0])
    dut.advance(0.015)
    assert dut.commands == pytest.approx([-15.0, 5.0, 5.0, -15.0], abs=1e-12)  # gtest: 489


def test_a_deactivated_controller_writes_nothing_and_accepts_commands_when_it_is_activated_again():
    dut = drive()
    dut.send(x=1.0, y=1.0, z=1.0)
    dut.advance(0.005)
    assert dut.commands == pytest.approx([-15.0, 5.0, 5.0, -15.0], abs=1e-12)  # gtest: 557
    dut.controller.deactivate(dut.context)
    dut.advance(0.015)
    assert np.nan_to_num(dut.commands).tolist() == [0.0] * 4  # gtest: 569; NaN lets the joints stand still
    dut.activate()
    dut.advance(0.025)
    assert np.nan_to_num(dut.commands).tolist() == [0.0] * 4  # gtest: 586
    dut.send(x=1.0, y=1.0, z=1.0)
    dut.advance(0.035)
    assert dut.commands == pytest.approx([-15.0, 5.0, 5.0, -15.0], abs=1e-12)  # gtest: 598


def test_a_stamp_of_zero_means_now():
    dut = drive()
    dut.advance(2.0)
    dut.send(x=1.0, y=1.0, z=1.0, stamp=0.0)
    dut.advance(2.015)
    assert dut.commands == pytest.approx([-15.0, 5.0, 5.0, -15.0], abs=1e-12)  # gtest: 637


@pytest.mark.parametrize(
    ("count", "offset", "expected"),
    [
        (3, 0.0, [-15.0, 8.66025, -8.66025]),  # gtest: 691
        (3, 1.0471975512, [-1.33975, 5.0, -18.6603]),  # gtest: 758
        (4, 0.7853981634, [-5.0, 9.14214, -5.0, -19.1421]),  # gtest: 825
        (5, 0.0, [-15.0, 1.42040, 8.96802, -2.78768, -17.6007]),  # gtest: 892
    ],
)
def test_any_number_of_wheels_turns(count, offset, expected):
    dut = drive({"wheel_names": wheels(count), "wheel_offset": offset})
    dut.send(x=1.0, y=1.0, z=1.0)
    dut.advance(0.005)
    assert dut.commands == pytest.approx(expected, abs=1e-4)


def test_a_timeout_of_zero_is_for_ever_and_a_command_that_is_not_finite_is_refused():
    dut = drive({"cmd_vel_timeout": 0.0})
    dut.send(x=1.0, y=1.0, z=1.0)
    for bad in (nan, np.inf):
        with pytest.raises(CommandError, match=r"linear.y is (nan|inf), which is not a finite number"):
            dut.send(y=bad)
    dut.advance(9.0)
    assert dut.commands == pytest.approx([-15.0, 5.0, 5.0, -15.0], abs=1e-12)


@pytest.mark.parametrize("feedback", [{"position_feedback": True}, {"position_feedback": False}, {"open_loop": True}])
def test_odometry_follows_an_arc_in_any_direction(feedback):
    dut = drive({"wheel_names": wheels(3), "wheel_offset": 0.3} | feedback)
    dut.commands_while(2.0, x=0.3, y=-0.2, z=0.5)
    x, y, heading, *velocity = dut.odometry
    assert velocity == pytest.approx([0.3, -0.2, 0.5])
    assert heading == pytest.approx(0.5 * 1.99, abs=0.006)
    # The motion of a rigid body at a constant twist.
    expected = np.array([[sin(heading), cos(heading) - 1], [1 - cos(heading), sin(heading)]]) @ [0.3, -0.2] / 0.5
    assert (x, y) == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize(("open_loop", "seen"), [(True, 0.3), (False, 0.0)])
def test_open_loop_odometry_has_the_commanded_velocity_at_once(open_loop, seen):
    dut = drive({"open_loop": open_loop})
    dut.advance(0.005)
    dut.send(x=0.3)
    dut.advance(0.015)
    assert dut.odometry[3] == seen


def test_odometry_follows_a_straight_line_after_a_turn():
    dut = drive({"open_loop": True})
    dut.commands_while(1.0, z=pi / 2)
    _, _, heading, *_ = dut.odometry
    before = dut.odometry[:2]
    dut.commands_while(2.0, x=0.3, y=0.1)
    turn = np.array([[cos(heading), -sin(heading)], [sin(heading), cos(heading)]])
    assert dut.odometry[:2] - before == pytest.approx(turn @ [0.3, 0.1], abs=0.02)


def test_odometry_and_its_transform_are_published_at_every_update():
    dut = drive({"diagonal_covariance": {"pose": [0.1] * 6, "twist": [0.2] * 6}})
    dut.commands_while(0.2, x=0.3)
    odom, (transform,) = dut.message("odom"), dut.message("tf_odometry").transforms
    assert odom.header == transform.header
    assert odom.header.stamp.nanosec == 190_000_000
    assert (odom.pose.covariance[0], odom.twist.covariance[35]) == (0.1, 0.2)
    assert "tf_odometry" not in drive({"enable_odom_tf": False}).controller.published
