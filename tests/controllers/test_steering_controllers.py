from math import atan, nan, tan

import numpy as np
import pytest
from drive_harness import Driven

from drake_twin.controllers.controller import Upstream
from drake_twin.errors import CommandError, InputError

BICYCLE = "bicycle_steering_controller/BicycleSteeringController"
TRICYCLE = "tricycle_steering_controller/TricycleSteeringController"
ACKERMANN = "ackermann_steering_controller/AckermannSteeringController"

ONE = {"traction_joints_names": ["wheel"], "steering_joints_names": ["steer"]}
TWO = {"traction_joints_names": ["right", "left"]}
PARAMETERS = {
    BICYCLE: ONE | {"wheelbase": 0.5, "traction_wheel_radius": 0.1},
    TRICYCLE: ONE | TWO | {"wheelbase": 0.5, "traction_wheels_radius": 0.1, "traction_track_width": 0.4},
    ACKERMANN: TWO
    | {"steering_joints_names": ["steer_right", "steer_left"]}
    | {"wheelbase": 0.5, "traction_wheels_radius": 0.1, "traction_track_width": 0.4},
}
every_kind = pytest.mark.parametrize("kind", PARAMETERS)


def drive(kind, parameters=None, **setup):
    return Driven(kind, PARAMETERS[kind] | (parameters or {}), **setup)


def test_the_claims_are_velocities_of_the_driven_wheels_then_positions_of_the_steering_joints():
    claims = {kind: list(map(str, drive(kind).controller.claims)) for kind in PARAMETERS}
    assert claims == {
        BICYCLE: ["wheel/velocity", "steer/position"],
        TRICYCLE: ["right/velocity", "left/velocity", "steer/position"],
        ACKERMANN: ["right/velocity", "left/velocity", "steer_right/position", "steer_left/position"],
    }


@every_kind
def test_before_the_first_message_the_wheels_are_held_and_nothing_steers(kind):
    dut = drive(kind)
    dut.advance(0.005)
    velocity = np.array([claim.name == "velocity" for claim in dut.controller.claims])
    assert (np.array(dut.commands)[velocity] == 0.0).all()
    assert np.isnan(np.array(dut.commands)[~velocity]).all()


@every_kind
def test_a_command_is_reached_and_its_circle_reckoned(kind):
    # radius 1 about (0, 1)
    dut = drive(kind, {"velocity_rolling_window_size": 1})
    dut.commands_while(3.0, x=0.5, z=0.5)
    x, y, heading, linear, _, angular = dut.odometry
    assert (linear, angular) == pytest.approx((0.5, 0.5))
    assert heading == pytest.approx(0.5 * 3.0, abs=0.02)
    # In the first update the wheels do not steer yet, as far as anyone measures: 10 ms straight on.
    assert (x, y) == pytest.approx((np.sin(heading), 1 - np.cos(heading)), abs=0.006)


def test_ackermanns_steering_angles_meet_in_one_point():
    dut = drive(ACKERMANN)
    dut.commands_while(0.1, x=0.5, z=0.5)
    right, left, steer_right, steer_left = dut.commands
    assert (right * 0.1, left * 0.1) == pytest.approx((0.5 * 1.2, 0.5 * 0.8))
    assert (tan(steer_right), tan(steer_left)) == pytest.approx((0.5 / 1.2, 0.5 / 0.8))


@every_kind
def test_steering_timeout_stops_the_wheels_and_keeps_the_angle(kind):
    dut = drive(kind)
    dut.send(x=0.5, z=0.5)
    dut.advance(1.005)
    velocity = np.array([claim.name == "velocity" for claim in dut.controller.claims])
    moving = np.array(dut.commands)
    dut.advance(1.015)
    stopped = np.array(dut.commands)
    assert (moving[velocity] > 0.0).all()
    assert (stopped[velocity] == 0.0).all()
    assert stopped[~velocity].tolist() == moving[~velocity].tolist()


def test_a_timeout_of_zero_uses_a_command_up_in_one_update():
    dut = drive(BICYCLE, {"reference_timeout": 0.0})
    dut.send(x=0.5)
    dut.advance(0.005)
    assert dut.commands == pytest.approx([5.0, 0.0])
    dut.advance(0.015)
    assert dut.commands == [0.0, 0.0]


def test_a_nan_element_stops_and_an_infinite_one_is_refused():
    dut = drive(BICYCLE)
    dut.send(x=0.5)
    dut.advance(0.005)
    with pytest.raises(CommandError, match=r"the command's angular.z is -inf"):
        dut.send(z=-np.inf)
    dut.send(z=nan)
    dut.advance(0.015)
    assert dut.commands == [0.0, 0.0]


def test_open_loop_reckons_from_the_commands():
    dut = drive(TRICYCLE, {"open_loop": True})
    right, left, _ = dut.commands_while(0.01, x=0.5, z=0.5)[0]
    assert (right * 0.1, left * 0.1) == pytest.approx((0.5 * 1.2, 0.5 * 0.8))  # at once, not after the wheels steered
    assert dut.odometry[3:].tolist() == [0.5, 0.0, 0.5]


def test_wheels_turn_slower_until_the_angle_is_reached():
    dut = drive(BICYCLE, {"reduce_wheel_speed_until_steering_reached": True})
    (first, *_, last) = dut.commands_while(0.1, x=0.1, z=0.5)
    angle = atan(0.5 * 0.5 / 0.1)
    assert first[0] == pytest.approx(np.cos(angle) / np.cos(np.pi / 6))
    assert last[0] == pytest.approx(1.0)


def test_position_feedback_reckons_from_the_wheels_positions():
    dut = drive(BICYCLE, {"position_feedback": True, "velocity_rolling_window_size": 1}, wheels=[7.0, 0.0])
    dut.commands_while(1.0, x=0.5)
    assert dut.odometry[0] == pytest.approx(0.5 * 0.989, abs=0.001)
    state = dut.message("controller_state")
    assert state.traction_wheels_position == pytest.approx([7.0 + 5.0 * 0.989], abs=0.01)
    assert state.traction_wheels_velocity.size == 0


def test_the_controllers_state_says_what_is_measured_and_commanded():
    dut = drive(ACKERMANN)
    dut.commands_while(0.1, x=0.5, z=0.5)
    state = dut.message("controller_state")
    assert state.traction_wheels_velocity == pytest.approx(dut.commands[:2])
    assert state.steer_positions == pytest.approx(dut.commands[2:])
    assert state.linear_velocity_command.tolist() == dut.commands[:2]
    assert state.steering_angle_command.tolist() == dut.commands[2:]
    assert state.header.frame_id == "odom"


def test_odometry_and_its_transform_agree():
    dut = drive(ACKERMANN)
    dut.commands_while(0.2, x=0.5, z=0.5)
    odom, (transform,) = dut.message("odometry"), dut.message("tf_odometry").transforms
    assert odom.header == transform.header
    assert odom.pose.pose.position.x == transform.transform.translation.x > 0.0
    assert np.diag(odom.twist.covariance.reshape(6, 6)).tolist() == [0, 7, 14, 21, 28, 35]


def test_humbles_names_for_front_and_rear_wheels():
    names = {
        "front_wheels_names": ["steer_right", "steer_left"],
        "rear_wheels_names": ["right", "left"],
        "front_wheel_track": 0.3,
        "rear_wheel_track": 0.4,
        "front_wheels_radius": 0.2,
        "rear_wheels_radius": 0.1,
        "wheelbase": 0.5,
    }
    front = Driven(ACKERMANN, names)
    assert list(map(str, front.controller.claims)) == [
        "right/velocity",
        "left/velocity",
        "steer_right/position",
        "steer_left/position",
    ]
    drive_of = front.controller.setup.parameters.kinematics()
    assert (drive_of.driven_track, drive_of.steered_track, drive_of.wheel_radius) == (0.4, 0.3, 0.1)
    rear = Driven(ACKERMANN, names | {"front_steering": False})
    assert str(rear.controller.claims[0]) == "steer_right/velocity"
    assert rear.controller.setup.parameters.kinematics().driven_track == 0.3


def test_unstamped_commands_have_their_own_topic():
    dut = drive(BICYCLE, {"use_stamped_vel": False})
    assert dut.controller.subscribed == {"reference_unstamped": "geometry_msgs/msg/Twist"}
    dut.send(x=0.5)
    dut.advance(0.005)
    assert dut.commands == pytest.approx([5.0, 0.0])


def test_chained_references_take_the_place_of_the_topic():
    dut = drive(BICYCLE, upstream={"above": Upstream(2, (0, 1))})
    dut.controller.GetInputPort("above").FixValue(dut.context, [0.5, 0.0])
    dut.advance(0.005)
    assert dut.commands == pytest.approx([5.0, 0.0])


@pytest.mark.parametrize(
    ("kind", "parameters", "text"),
    [
        (
            ACKERMANN,
            {"traction_joints_names": ["one"]},
            r"has 2 traction joints, but traction_joints_names has 1: \[one\]",
        ),
        (BICYCLE, {"steering_joints_names": []}, r"has 1 steering joint, but steering_joints_names has 0: \[\]"),
        (
            TRICYCLE,
            {"steering_joints_state_names": ["a", "b"]},
            "has 1 steering joint, but steering_joints_state_names has",
        ),
        (ACKERMANN, {"traction_joints_names": ["a", "a"]}, "traction_joints_names has a duplicate name"),
        (BICYCLE, {"traction_wheel_radius": 0.0}, "the radius of the traction wheels is missing or not positive"),
        (
            TRICYCLE,
            {"traction_track_width": 0.0},
            "the track width of the traction wheels is missing or not positive",
        ),
        (BICYCLE, {"wheelbase": 0.0}, "0.0 is not above 0"),
    ],
)
def test_parameters_that_cannot_be_are_refused(kind, parameters, text):
    with pytest.raises(InputError, match=text):
        drive(kind, parameters)


def test_the_twins_own_limits_for_robots_that_gazebos_plugins_drive():
    dut = drive(BICYCLE, {"linear.x.max_acceleration": 1.0, "largest_steering_angle": 0.3})
    commands = dut.commands_while(0.03, x=0.5, z=9.0)
    np.testing.assert_allclose(commands, [[0.1, 0.3], [0.2, 0.3], [0.3, 0.3]])


def test_the_twins_own_commands_of_an_angle():
    dut = drive(BICYCLE, {"angular_is_steering_angle": True, "largest_steering_angle": 0.3})
    dut.send(x=0.0, z=0.2)
    dut.advance(0.005)
    assert dut.commands == [0.0, 0.2]
    dut.send(x=-0.5, z=0.4)
    dut.advance(0.015)
    assert dut.commands == pytest.approx([-5.0, -0.3])
