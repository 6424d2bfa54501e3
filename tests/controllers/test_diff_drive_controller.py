"""Rows of the behaviour table for diff_drive_controller, and what its parameters mean."""

from math import nan, pi

import numpy as np
import pytest
from drive_harness import Driven

from drake_twin.controllers.base_controller import Upstream
from drake_twin.controllers.diff_drive_controller import DiffDriveController, DiffDriveParameters
from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.parameters import read_parameters
from drake_twin.errors import CommandError, InputError

KIND = "diff_drive_controller/DiffDriveController"
WHEELS = {"left_wheel_names": ["left"], "right_wheel_names": ["right"], "wheel_separation": 0.5, "wheel_radius": 0.1}


def drive(parameters=None, **setup):
    return Driven(KIND, WHEELS | (parameters or {}), **setup)


def test_before_the_first_message_nothing_is_written_until_the_timeout_and_then_zero():
    dut = drive()
    dut.advance(0.505)
    assert np.isnan(dut.commands).all()
    dut.advance(0.515)
    assert dut.commands == [0.0, 0.0]


def test_a_command_turns_the_wheels():
    dut = drive()
    dut.send(x=0.3, z=1.0)
    dut.advance(0.005)
    assert dut.commands == pytest.approx([(0.3 - 0.25) / 0.1, (0.3 + 0.25) / 0.1])


def test_diff_drive_timeout_brakes():
    dut = drive()
    dut.send(x=0.3)
    dut.advance(0.505)
    assert dut.commands == pytest.approx([3.0, 3.0])
    dut.advance(0.515)
    assert dut.commands == [0.0, 0.0]


def test_diff_drive_timeout_brakes_within_the_limits():
    dut = drive({"linear.x.max_acceleration": 1.0, "linear.x.max_deceleration": -0.5})
    dut.commands_while(0.5, x=0.3)
    dut.advance(1.005)  # the last command came at 0.49
    dut.advance(1.105)
    assert dut.commands[0] == pytest.approx((0.3 - 0.5 * 0.11) / 0.1)


def test_a_timeout_of_zero_holds_a_command_for_ever():
    dut = drive({"cmd_vel_timeout": 0.0})
    dut.send(x=0.3)
    dut.advance(20.005)
    assert dut.commands == pytest.approx([3.0, 3.0])


def test_a_stamp_in_the_past_counts_and_one_in_the_future_means_now():
    dut = drive()
    dut.advance(2.0)
    dut.send(x=0.3, stamp=1.6)
    dut.advance(2.105)
    assert dut.commands == pytest.approx([3.0, 3.0])
    dut.advance(2.115)
    assert dut.commands == [0.0, 0.0]
    dut.send(x=0.3, stamp=1.7e9)  # a program that stamps with the wall's time
    dut.advance(2.605)
    assert dut.commands == pytest.approx([3.0, 3.0])
    dut.advance(2.635)
    assert dut.commands == [0.0, 0.0]


def test_a_message_older_than_the_timeout_is_refused():
    dut = drive()
    dut.advance(2.0)
    with pytest.raises(
        CommandError, match=r"the command's stamp is 1 s old, but a command expires after 0.5 s"
    ) as error:
        dut.send(x=0.3, stamp=1.0)
    assert not error.value.deactivates


@pytest.mark.parametrize("bad", [{"x": np.inf}, {"z": np.nan}])
def test_a_nan_or_infinite_element_is_refused_and_the_command_before_it_stays(bad):
    dut = drive()
    dut.send(x=0.3)
    with pytest.raises(CommandError, match=r"the command's (linear.x|angular.z) is (inf|nan), which is not a finite"):
        dut.send(**bad)
    dut.advance(0.005)
    assert dut.commands == pytest.approx([3.0, 3.0])


def test_a_message_while_inactive_is_ignored_and_nothing_is_written_after_reactivation():
    dut = drive()
    dut.send(x=0.3)
    dut.advance(0.1)
    dut.controller.deactivate(dut.context)
    dut.send(x=0.7)
    dut.advance(1.0)
    assert dut.commands == [0.0, 0.0]
    dut.activate()
    dut.advance(1.005)
    assert np.isnan(dut.commands).all()
    dut.send(x=0.1)
    dut.advance(1.015)
    assert dut.commands == pytest.approx([1.0, 1.0])


def test_reactivation_goes_on_with_the_odometry_and_ramps_from_rest():
    dut = drive({"linear.x.max_acceleration": 1.0})
    dut.commands_while(0.5, x=0.3)
    before = dut.odometry
    dut.controller.deactivate(dut.context)
    dut.advance(1.0)
    dut.activate()
    (first, *_) = dut.commands_while(1.02, x=0.3)
    assert first[0] == pytest.approx(0.01 / 0.1)
    assert dut.odometry[0] == pytest.approx(before[0], abs=0.01)


def test_diff_drive_limits_make_the_ramp_they_describe():
    dut = drive(
        {
            "linear": {"x": {"max_velocity": 0.3, "max_acceleration": 1.0}},
            "angular": {"z": {"max_velocity": 0.0}},
            "publish_limited_velocity": True,
        }
    )
    wheels = dut.commands_while(0.5, x=9.0, z=9.0)
    np.testing.assert_allclose(wheels[:, 0] * 0.1, np.minimum(0.3, 0.01 * np.arange(1, 51)), atol=1e-12)
    assert wheels[:, 1].tolist() == wheels[:, 0].tolist()
    limited = dut.message("cmd_vel_out")
    assert (limited.twist.linear.x, limited.twist.angular.z) == (0.3, 0.0)
    assert limited.header.stamp.nanosec == 490_000_000


def test_jerk_is_limited_over_the_last_two_updates():
    dut = drive({"linear.x.max_jerk": 100.0})
    wheels = dut.commands_while(0.04, x=9.0)
    np.testing.assert_allclose(wheels[:, 0] * 0.1, [0.01, 0.03, 0.06, 0.10])  # 100 · 0.01² more each time


def test_a_jerk_limit_of_zero_is_not_applied_and_said():
    """ROS 2 Jazzy's limiter never lets the speed leave 0 with it; a file of Humble means no limit."""
    dut = drive({"linear.x.max_jerk": 0.0, "linear.x.min_jerk": 0.0})
    wheels = dut.commands_while(0.04, x=0.3)
    assert wheels[-1, 0] * 0.1 == pytest.approx(0.3)
    (warning,) = dut.controller.warnings
    assert warning.startswith("linear.x.max_jerk is 0, with which it never moves in ROS 2 Jazzy")


def test_has_limits_false_switches_limits_off_as_in_humble():
    limits = {
        "has_velocity_limits": False,
        "max_velocity": 0.1,
        "has_acceleration_limits": False,
        "max_acceleration": 0.1,
    }
    dut = drive({"linear.x": limits})
    dut.send(x=0.3)
    dut.advance(0.005)
    assert dut.commands == pytest.approx([3.0, 3.0])


def test_multipliers_correct_the_geometry():
    dut = drive(
        {"wheel_separation_multiplier": 1.2, "left_wheel_radius_multiplier": 0.9, "right_wheel_radius_multiplier": 1.1}
    )
    dut.send(x=0.3, z=1.0)
    dut.advance(0.005)
    assert dut.commands == pytest.approx([(0.3 - 0.3) / 0.09, (0.3 + 0.3) / 0.11])


def test_wheels_of_a_side_turn_alike_and_their_claims_are_left_then_right():
    dut = drive({"left_wheel_names": ["fl", "rl"], "right_wheel_names": ["fr", "rr"]})
    assert list(map(str, dut.controller.claims)) == ["fl/velocity", "rl/velocity", "fr/velocity", "rr/velocity"]
    dut.send(z=1.0)
    dut.advance(0.005)
    assert dut.commands == pytest.approx([-2.5, -2.5, 2.5, 2.5])


@pytest.mark.parametrize("feedback", [{"position_feedback": True}, {"position_feedback": False}, {"open_loop": True}])
def test_odometry_of_a_circle_comes_back_to_its_start(feedback):
    # 0.4 m/s and 0.8 rad/s: a circle of radius 0.5 about (0, 0.5) in 2 π / 0.8 s
    dut = drive({"publish_rate": 1000.0} | feedback)
    dut.commands_while(3.9, x=0.4, z=0.8)
    x, y, heading, linear, _, angular = dut.odometry
    assert (linear, angular) == pytest.approx((0.4, 0.8))
    # The wheels start to turn a step of the joints, or an update of the controller, after the command.
    assert abs((heading % (2 * pi)) - (0.8 * 3.9 % (2 * pi))) < 0.8 * 0.0101
    assert (x, y) == pytest.approx((0.5 * np.sin(heading), 0.5 * (1 - np.cos(heading))), abs=1e-9)


def test_odometry_starts_at_zero_with_wheels_at_any_angle():
    dut = drive(wheels=[3.0, -40.0])
    dut.advance(0.1)
    assert dut.odometry.tolist() == [0.0] * 6


def test_odometry_and_its_transform_agree_and_are_stamped_with_the_update():
    dut = drive({"pose_covariance_diagonal": [1, 2, 3, 4, 5, 6], "publish_rate": 1000.0})
    dut.commands_while(0.2, x=0.4, z=0.8)
    odom, (transform,) = dut.message("odom"), dut.message("tf_odometry").transforms
    assert odom.header.stamp.nanosec == 190_000_000
    assert (odom.header, odom.child_frame_id) == (transform.header, transform.child_frame_id)
    assert odom.pose.pose.orientation == transform.transform.rotation
    assert odom.pose.pose.position.x == transform.transform.translation.x != 0.0
    assert np.diag(odom.pose.covariance.reshape(6, 6)).tolist() == [1, 2, 3, 4, 5, 6]


def test_odometry_is_published_at_its_rate():
    dut = drive({"publish_rate": 20.0})
    stamps = []
    for step in range(41):
        dut.advance(0.01 * step + 0.005)
        stamps.append(dut.message("odom").header.stamp.nanosec)
    # as upstream counts: the first update, then the first one later than each period
    assert sorted({stamp // 1_000_000 for stamp in stamps}) == [0, 60, 110, 160, 210, 260, 310, 360]


def test_there_is_no_transform_where_it_is_not_enabled():
    assert "tf_odometry" not in drive({"enable_odom_tf": False}).controller.published


def test_reset_odometry_goes_back_to_the_origin():
    dut = drive({"publish_rate": 1000.0})
    dut.commands_while(0.2, x=0.4)
    dut.controller.reset_odometry(dut.context)
    dut.commands_while(0.21, x=0.4)
    assert dut.odometry[0] == pytest.approx(0.004)


def test_unstamped_commands_have_their_own_topic():
    dut = drive({"use_stamped_vel": False})
    assert dut.controller.subscribed == {"cmd_vel_unstamped": "geometry_msgs/msg/Twist"}
    dut.advance(1.0)
    dut.send(x=0.3)
    dut.advance(1.495)
    assert dut.commands == pytest.approx([3.0, 3.0])
    dut.advance(1.515)
    assert dut.commands == [0.0, 0.0]


def test_chained_references_take_the_place_of_the_topic():
    dut = drive(upstream={"above": Upstream(2, (1, 0))})
    assert list(map(str, DiffDriveController.reference_interfaces(None, None))) == [
        "linear/velocity",
        "angular/velocity",
    ]
    dut.send(x=0.3)
    dut.controller.GetInputPort("above").FixValue(dut.context, [1.0, 0.1])  # angular first
    dut.advance(0.005)
    assert dut.commands == pytest.approx([(0.1 - 0.25) / 0.1, (0.1 + 0.25) / 0.1])
    dut.controller.GetInputPort("above").FixValue(dut.context, [nan, nan])
    dut.advance(0.015)
    assert dut.commands == pytest.approx([3.0, 3.0])


def test_a_chained_wheel_is_measured_at_its_joint():
    dut = drive({"left_wheel_names": ["pid_left/left"], "right_wheel_names": ["pid_right/right"]})
    assert list(map(str, dut.controller.claims)) == ["pid_left/left/velocity", "pid_right/right/velocity"]
    dut.commands_while(0.3, x=0.2)
    assert dut.odometry[0] == pytest.approx(0.2 * 0.29, rel=0.05)


def test_a_saved_context_is_a_saved_controller():
    def run(dut):
        return np.vstack([dut.commands_while(0.8, x=0.5, z=0.2), [[*dut.odometry[:2]]]])

    one, other = (drive({"linear.x.max_acceleration": 0.5, "linear.x.max_jerk": 2.0}) for _ in range(2))
    one.commands_while(0.4, x=0.5, z=0.2)
    other.root.SetTimeStateAndParametersFrom(one.root)
    other.simulator.Initialize()
    assert run(one).tolist() == run(other).tolist()


OFF = {"tf_frame_prefix_enable": False}


@pytest.mark.parametrize(
    ("namespace", "prefix", "links", "parameters", "frames"),
    [
        # test_diff_drive_controller.cpp:340-483, test_mecanum_drive_controller.cpp:133-302
        ("", "", ["base_link"], {**OFF, "tf_frame_prefix": "test_prefix"}, ("odom", "base_link")),
        ("", "", ["base_link"], {"tf_frame_prefix": "test_prefix"}, ("test_prefix/odom", "test_prefix/base_link")),
        ("", "", ["base_link"], {}, ("odom", "base_link")),
        ("/test_namespace", "", ["base_link"], {**OFF, "tf_frame_prefix": "test_prefix"}, ("odom", "base_link")),
        (
            "/test_namespace",
            "",
            ["base_link"],
            {"tf_frame_prefix": "test_prefix"},
            ("test_prefix/odom", "test_prefix/base_link"),
        ),
        ("/test_namespace", "", ["base_link"], {}, ("test_namespace/odom", "test_namespace/base_link")),
        ("/robot_1", "", ["robot_1/base_link"], {"tf_frame_prefix": "~"}, ("robot_1/odom", "robot_1/base_link")),
        ("/robot_1", "", ["chassis"], {"tf_frame_prefix": "/a/", "base_frame_id": "chassis"}, ("a/odom", "a/chassis")),
        # the twin's own prefix, which keeps robots apart
        ("/robot_1", "robot_1/", ["base_link"], {}, ("robot_1/odom", "robot_1/base_link")),
        ("/robot_1", "robot_1/", ["base_link"], OFF, ("robot_1/odom", "robot_1/base_link")),
        ("/robot_1", "r/", ["base_link"], {}, ("r/robot_1/odom", "r/robot_1/base_link")),
        ("/robot_1", "", ["robot_1_base_link"], OFF, ("odom", "robot_1_base_link")),
    ],
)
def test_the_frames_of_the_odometry(namespace, prefix, links, parameters, frames):
    dut = drive(parameters, namespace=namespace, frame_prefix=prefix, links=links)
    dut.advance(0.005)
    odom = dut.message("odom")
    assert (odom.header.frame_id, odom.child_frame_id) == frames


def test_the_parameters_of_ros2_controllers_defaults():
    parameters, _ = read_parameters(DiffDriveParameters, ControllerParameters("drive", KIND, WHEELS))
    assert (parameters.cmd_vel_timeout, parameters.publish_rate, parameters.velocity_rolling_window_size) == (
        0.5,
        50,
        10,
    )
    assert parameters.position_feedback
    assert parameters.tf_frame_prefix_enable
    assert parameters.enable_odom_tf
    assert not parameters.open_loop
    assert np.isnan(parameters.linear.x.max_velocity)


def test_humbles_names_are_accepted_with_a_warning_where_they_change_nothing():
    dut = drive({"wheels_per_side": 1, "linear.x.min_acceleration": -1.0, "publish_wheel_data": True})
    assert dut.warnings == (
        "controller drive: unknown parameter 'publish_wheel_data': it is ignored",
        (
            "controller drive: linear.x.min_acceleration is ignored: ros2_controllers reads"
            " max_acceleration_reverse and max_deceleration since Jazzy"
        ),
        "controller drive: wheels_per_side is ignored: the number of wheels follows from their names",
    )


@pytest.mark.parametrize(
    ("parameters", "text"),
    [
        ({"wheel_radius": 0.0}, "0.0 is not above 0"),
        ({"right_wheel_names": []}, "the list is empty"),
        ({"right_wheel_names": ["a", "b"]}, r"left wheels \[1\] and the number of right wheels \[2\] are different"),
        ({"pose_covariance_diagonal": [0.1]}, "pose_covariance_diagonal has 1 elements; it needs six"),
        ({"linear.x.max_velocity": -1.0}, "-1.0 is below 0"),
        ({"linear.x.min_jerk": 1.0}, "1.0 is above 0"),
        ({"wheel_separation": nan}, "nan is not a number"),
    ],
)
def test_parameters_that_cannot_be_are_refused(parameters, text):
    with pytest.raises(InputError, match=text):
        drive(parameters)


def test_a_missing_geometry_is_refused():
    with pytest.raises(InputError, match="the parameter 'wheel_separation' is missing"):
        Driven(KIND, {"left_wheel_names": ["left"], "right_wheel_names": ["right"]})


def test_deactivation_leaves_zero_velocities_and_nothing_on_another_controllers_references():
    dut = drive()  # test_diff_drive_controller.cpp:826-843
    dut.send(x=0.3)
    dut.advance(0.005)
    assert min(dut.commands) > 0.0
    dut.controller.deactivate(dut.context)
    assert dut.commands == [0.0, 0.0]

    chained = drive({"left_wheel_names": ["pid/left"]})  # the PID goes back to its own topic
    chained.send(x=0.3)
    chained.advance(0.005)
    chained.controller.deactivate(chained.context)
    assert np.isnan(chained.commands[0])
    assert chained.commands[1] == 0.0
