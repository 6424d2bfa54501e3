"""gz-sim's TrackController and TrackedVehicle on their own: commands, limits, odometry, and what a file may say."""

from math import inf, nan

import numpy as np
import pytest
from controller_parameters import parameters_of
from device_harness import ROBOT, Running, setup_of

from drake_twin.controllers.tracks import Tracks
from drake_twin.description.gazebo_drive import TRACKS
from drake_twin.description.surface_velocity import NEEDS, has_surface_velocity
from drake_twin.errors import CommandError, InputError
from drake_twin.messages.interface_types import make

FIRST = 0.01  # s, of the first update
PALM, FINGER = {"link": "palm"}, {"link": "finger_link"}
VEHICLE = {"left_tracks": ["l"], "right_tracks": ["r"], "tracks_separation": 0.4, "use_stamped_vel": False}
TRACKS_OF_VEHICLE = {"l": PALM, "r": FINGER}


def running(*, tracks=None, **parameters):
    values = parameters_of(TRACKS, tracks={"belt": PALM} if tracks is None else tracks, **parameters)
    controller = Tracks(setup_of(Tracks, values))
    return Running(controller, state=np.zeros(4), **dict.fromkeys(controller.subscribed))


def vehicle(**parameters):
    return running(tracks=TRACKS_OF_VEHICLE, **VEHICLE | parameters)


def number(value):
    return make("std_msgs/msg/Float64", {"data": value})


def twist(x, z):
    return make("geometry_msgs/msg/Twist", {"linear": {"x": x, "y": 0.0, "z": 0.0}, "angular": {"z": z}})


def speeds(run):
    return run.controller.GetOutputPort("surface_speeds").Eval(run.context).tolist()


def after(run, time):
    run.advance(time)
    assert run.controller.fault(run.context) is None
    return speeds(run)


def test_a_track_stands_still_until_a_command_and_while_inactive():
    run = running()
    assert after(run, 0.02) == [0.0]
    run.send("belt/track_cmd_vel", number(0.7))
    assert after(run, 0.03) == [0.7]
    assert after(run, 0.5) == [0.7]
    run.controller.deactivate(run.context)
    assert speeds(run) == [0.0]


def test_a_command_has_an_age():
    run = running(tracks={"belt": PALM | {"max_command_age": 0.2}})
    run.send("belt/track_cmd_vel", number(0.7))
    assert after(run, 0.2) == [0.7]
    assert after(run, 0.22) == [0.0]
    run.send("belt/track_cmd_vel", number(0.7))
    assert after(run, 0.23) == [0.7]


def test_a_track_has_limits():
    limits = {"min_velocity": -0.3, "max_velocity": 0.5, "max_acceleration_reverse": -2.0, "max_acceleration": 1.0}
    run = running(tracks={"belt": PALM | {"limits": limits}})
    run.send("belt/track_cmd_vel", number(9.0))
    assert after(run, 0.01) == pytest.approx([0.01])
    assert after(run, 0.1) == pytest.approx([0.1])
    assert after(run, 1.0) == [0.5]
    run.send("belt/track_cmd_vel", number(-9.0))
    assert after(run, 1.1) == pytest.approx([0.3])
    assert after(run, 2.0) == [-0.3]


def test_the_odometry_of_a_track_is_its_way_at_its_rate():
    run = running(tracks={"belt": PALM | {"odometry_publish_frequency": 10.0}})
    run.send("belt/track_cmd_vel", number(0.5))
    times = []
    for count in range(1, 42):
        run.advance(0.01 * count)
        message = run.output("belt/odometry")
        time = message.header.stamp.sec + message.header.stamp.nanosec * 1e-9
        assert message.pose.pose.position.x == pytest.approx(0.5 * (time - FIRST))
        times.append(time)
    assert sorted({round(time, 6) for time in times}) == [0.01, 0.1, 0.2, 0.3, 0.4]
    assert message.twist.twist.linear.x == 0.5


def test_a_vehicle_gives_its_sides_their_speeds():
    """v ∓ ω b / 2 e."""
    run = vehicle(steering_efficiency=0.8)
    run.send("cmd_vel_unstamped", twist(0.3, 0.2))
    assert after(run, 0.01) == pytest.approx([0.3 - 0.2 * 0.4 / 1.6, 0.3 + 0.2 * 0.4 / 1.6])
    run.send("steering_efficiency", number(0.4))
    assert after(run, 0.02) == pytest.approx([0.3 - 0.2 * 0.4 / 0.8, 0.3 + 0.2 * 0.4 / 0.8])


def test_the_last_of_the_vehicles_and_a_tracks_own_commands_holds():
    run = vehicle()
    run.send("l/track_cmd_vel", number(0.1))
    assert after(run, 0.01) == [0.1, 0.0]
    run.send("cmd_vel_unstamped", twist(0.3, 0.0))
    assert after(run, 0.02) == [0.3, 0.3]
    run.send("r/track_cmd_vel", number(0.2))
    assert after(run, 0.03) == [0.3, 0.2]
    run.send("cmd_vel_unstamped", twist(0.3, 0.0))
    assert after(run, 0.04) == [0.3, 0.3]


def test_a_vehicle_has_limits():
    run = vehicle(linear={"x": {"max_velocity": 0.5, "max_acceleration": 1.0}}, angular={"z": {"max_velocity": 0.1}})
    run.send("cmd_vel_unstamped", twist(2.0, 0.0))
    assert after(run, 0.1) == pytest.approx([0.1] * 2)
    run.send("cmd_vel_unstamped", twist(2.0, 5.0))
    assert after(run, 1.0) == pytest.approx([0.5 - 0.04, 0.5 + 0.04])


def test_the_odometry_of_a_vehicle_is_that_of_wheels():
    """On an arc, at the speeds that it wants of its tracks: with the efficiency of 0.5 it turns twice as far."""
    run = vehicle(odom_frame_id="map", base_frame_id="palm")
    run.send("cmd_vel_unstamped", twist(0.3, 0.2))
    after(run, 1.0)
    message = run.output("odom")
    pose = message.pose.pose
    turned = 0.4 * (1.0 - FIRST)
    assert 2 * np.arctan2(pose.orientation.z, pose.orientation.w) == pytest.approx(turned)
    place = 0.3 / 0.4 * np.array((np.sin(turned), 1 - np.cos(turned)))
    assert (pose.position.x, pose.position.y) == pytest.approx(place)
    assert (message.twist.twist.linear.x, message.twist.twist.angular.z) == pytest.approx((0.3, 0.4))
    assert (message.header.frame_id, message.child_frame_id) == ("map", "palm")
    (transform,) = run.output("tf_odometry").transforms
    assert transform.transform.translation.x == pose.position.x
    run.controller.reset_odometry(run.context)
    run.advance(1.01)
    assert run.output("odom").pose.pose.position.x == pytest.approx(0.003, abs=1e-5)


def test_the_odometries_continue_where_it_is_activated_again():
    run = vehicle()
    run.send("cmd_vel_unstamped", twist(0.5, 0.0))
    after(run, 0.4)
    run.controller.deactivate(run.context)
    for topic in run.controller.subscribed:
        run.fix(topic, None)
    run.advance(0.6)
    run.controller.activate(run.context)
    assert after(run, 0.8) == [0.0, 0.0]
    assert run.output("odom").pose.pose.position.x == pytest.approx(0.5 * (0.4 - FIRST))
    assert run.output("l/odometry").pose.pose.position.x == pytest.approx(0.5 * (0.4 - FIRST))


@pytest.mark.parametrize("value", [nan, inf])
@pytest.mark.parametrize("topic", ["l/track_cmd_vel", "steering_efficiency"])
def test_numbers_that_are_refused(topic, value):
    with pytest.raises(CommandError, match=f"{topic}: {value:g} is not finite"):
        vehicle().send(topic, number(value))


@pytest.mark.parametrize("value", [0.0, -0.5])
def test_an_efficiency_is_above_zero(value):
    with pytest.raises(CommandError, match=f"steering_efficiency: {value:g} is not above zero"):
        vehicle().send("steering_efficiency", number(value))


def test_a_velocity_that_is_refused():
    with pytest.raises(CommandError, match=r"the command's linear.x is nan, which is not a finite number"):
        vehicle().send("cmd_vel_unstamped", twist(nan, 0.0))


@pytest.mark.parametrize(
    ("parameters", "what"),
    [
        ({}, "tracks is empty"),
        ({"tracks": {"a": PALM, "b": PALM}}, "several tracks have the link 'palm'"),
        ({"tracks": {"a": PALM | {"axis": [0.0, 1.0]}}}, "has to be three numbers that are not all 0"),
        ({"tracks": {"a": PALM | {"axis": [0.0, 0.0, 0.0]}}}, "has to be three numbers that are not all 0"),
        ({"tracks": {"a": PALM | {"axis": [0.0, inf, 0.0]}}}, "has to be three numbers that are not all 0"),
        ({"tracks": {"a": PALM | {"max_command_age": -1.0}}}, "-1.0 is below 0"),
        ({"tracks": {"l": PALM}, "left_tracks": ["l"]}, "right_tracks is empty"),
        ({"tracks": {"l": PALM}, "left_tracks": ["l"], "right_tracks": ["x"]}, "right_tracks has 'x'"),
        ({"tracks": TRACKS_OF_VEHICLE, **VEHICLE, "tracks_separation": 0.0}, "0.0 is not above 0"),
        ({"tracks": TRACKS_OF_VEHICLE, **VEHICLE, "steering_efficiency": 0.0}, "0.0 is not above 0"),
    ],
)
def test_parameters_that_are_refused(parameters, what):
    with pytest.raises(InputError, match=what):
        parameters_of(TRACKS, **parameters)


def test_links_and_the_drake_that_it_needs():
    assert Tracks.problem(parameters_of(TRACKS, tracks={"a": {"link": "toe"}}), ROBOT) == "the robot has no link 'toe'"
    problem = Tracks.problem(parameters_of(TRACKS, tracks={"a": PALM}), ROBOT)
    assert problem == (None if has_surface_velocity() else NEEDS)
