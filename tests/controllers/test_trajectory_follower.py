"""gz-sim's TrajectoryFollower (gz-sim-trajectory-follower-system): beside the motion of a mass and of an inertia."""

from math import cos, pi, radians, sin

import numpy as np
import pytest
from pydrake.math import RigidTransform, RollPitchYaw
from repeated_runs import goes_on_to_the_same_bits
from waters import box, twin_of

from drake_twin.controllers.trajectory_follower import TrajectoryFollowerParameters
from drake_twin.description.parameters import ParameterError
from drake_twin.errors import InputError
from drake_twin.findings import Kind

STEPS = (0.001, 0.01)
MASS, SIDE = 6.0, 1.0
INERTIA = MASS * SIDE**2 / 6
FORCE, TORQUE = 12.0, 0.5
WAY = "<waypoints><waypoint>{} {}</waypoint></waypoints>"


@pytest.fixture(params=STEPS, ids="{:g} s".format)
def step(request):
    return request.param


def follower(elements, link="hull"):
    name = 'filename="gz-sim-trajectory-follower-system" name="gz::sim::systems::TrajectoryFollower"'
    link = f"<link_name>{link}</link_name>" if link else ""
    force = f"<force>{FORCE}</force><torque>{TORQUE}</torque>"
    return f"\n<plugin {name}>{link}{force}{elements}</plugin>"


def sled(folder, elements, step=0.001, xyz=(0, 0, 0), yaw=0.0):
    """A twin of a box in free space."""
    text = box("sled", (SIDE, SIDE, SIDE), mass=MASS, more=follower(elements))
    return twin_of(folder, "<gravity>0 0 0</gravity>", step, {"sled": (text, xyz, (0, 0, yaw))})


def state(twin):
    return twin.entities.state("sled")


def test_a_link_that_points_to_its_waypoint_is_pushed(tmp_path, step):
    yaw = 0.6
    twin = sled(tmp_path, WAY.format(1 + 100 * cos(yaw), 100 * sin(yaw)), step, (1, 0, 3), yaw)
    twin.advance_to(2.0)
    way = FORCE / MASS / 2 * 2.0**2
    assert state(twin).position == pytest.approx((1 + way * cos(yaw), way * sin(yaw), 3), rel=0.01)
    assert state(twin).linear == pytest.approx((2 * FORCE / MASS * cos(yaw), 2 * FORCE / MASS * sin(yaw), 0), abs=1e-6)


@pytest.mark.parametrize("side", [1, -1])
def test_another_one_is_turned_to_it(tmp_path, step, side):
    twin = sled(tmp_path, WAY.format(0, side * 10), step)
    twin.advance_to(1.0)
    assert state(twin).angular == pytest.approx((0, 0, side * TORQUE / INERTIA), rel=0.01)
    angle = 2 * np.arcsin(state(twin).orientation[3])
    assert angle == pytest.approx(side * TORQUE / INERTIA / 2, rel=0.011)
    assert state(twin).linear == (0, 0, 0)


def test_the_torque_ends_within_the_tolerance(tmp_path, step):
    """It has done torque · (90° - 20°) of work then, which is the energy of the turn, and the force begins."""
    twin = sled(tmp_path, WAY.format(0, 10) + "<bearing_tolerance>20</bearing_tolerance>", step)
    rate = (2 * TORQUE * radians(70) / INERTIA) ** 0.5
    twin.advance_to(rate * INERTIA / TORQUE + 0.1)
    assert state(twin).angular[2] == pytest.approx(rate, rel=0.01)
    assert state(twin).linear[1] > 0.1


def test_it_goes_on_to_the_next_waypoint_and_only_turns_there(tmp_path):
    """2 m/s² for 0.5 m, and nothing more: at the waypoint behind it the link has to turn."""
    twin = sled(tmp_path, "<waypoints><waypoint>1 0</waypoint><waypoint>-9 0.1</waypoint></waypoints>")
    twin.advance_to(1.5)
    assert state(twin).linear[0] == pytest.approx((2 * FORCE / MASS * 0.5) ** 0.5, rel=0.01)
    assert state(twin).angular[2] == pytest.approx(TORQUE / INERTIA * (1.5 - (0.5 * 2 / 2.0) ** 0.5), rel=0.02)


@pytest.mark.parametrize(("loop", "ahead"), [("false", 1), ("true", 2)])
def test_the_last_waypoint_stays_and_a_loop_begins_again(tmp_path, loop, ahead):
    points = "<waypoints><waypoint>0 0</waypoint><waypoint>0.1 0</waypoint></waypoints>"
    twin = sled(tmp_path, f"{points}<loop>{loop}</loop>")
    twin.advance_to(0.5)
    controller = twin.built.parts["sled"].controllers["trajectory_follower"]
    assert len(controller.sample(controller.GetMyContextFromRoot(twin.context)).memory.ahead) == ahead
    assert state(twin).linear == (0, 0, 0)


def test_a_message_pauses_it(tmp_path):
    twin = sled(tmp_path, WAY.format(100, 0))
    twin.advance_to(0.5)
    twin.publish("/sled/trajectory_follower/pause", {"data": True})
    twin.advance_to(1.0)
    assert state(twin).linear[0] == pytest.approx(FORCE / MASS * 0.5, rel=0.01)
    twin.publish("/sled/trajectory_follower/pause", {"data": False})
    twin.advance_to(1.5)
    assert state(twin).linear[0] == pytest.approx(FORCE / MASS, rel=0.01)


def test_a_line_and_a_circle_begin_where_the_link_is():
    X_WB = RigidTransform(RollPitchYaw(0, 0, pi / 2), [3, 4, 5])
    line = TrajectoryFollowerParameters(link_name="l", line_direction=pi / 2, line_length=2.0)
    assert np.array(line.points(X_WB)) == pytest.approx(np.array([[3, 4], [1, 4]]))
    circle = TrajectoryFollowerParameters(link_name="l", circle_radius=2.0).points(X_WB)
    assert len(circle) == 8
    assert circle[0] == pytest.approx((5, 4))
    assert circle[2] == pytest.approx((3, 6))


def test_a_line_is_followed_from_the_first_place(tmp_path):
    twin = sled(tmp_path, "<line><direction>0</direction><length>5</length></line>", xyz=(7, 0, 0), yaw=pi / 2)
    twin.advance_to(1.0)
    assert state(twin).position == pytest.approx((7, FORCE / MASS / 2, 0), rel=0.04, abs=1e-3)


def test_it_goes_on_from_a_snapshot_and_is_repeated_to_the_same_bits(tmp_path):
    twin = sled(tmp_path, "<circle><radius>0.8</radius></circle><range_tolerance>0.3</range_tolerance>")
    twin.recorder.begin()
    twin.publish("/sled/trajectory_follower/pause", {"data": False})
    goes_on_to_the_same_bits(twin, tmp_path)


@pytest.mark.parametrize(
    ("plugin", "why"),
    [
        (follower(WAY.format(1, 2), link=""), "<link_name> is missing"),
        (follower(WAY.format(1, 2), link="keel"), "the robot has no link 'keel'"),
        (follower(""), "it has no <waypoints>, no <circle> and no <line>"),
        (follower("<waypoints/>"), "<waypoints> has no <waypoint>"),
        (follower("<circle/>"), "<circle/radius> is missing"),
        (follower("<line><direction>1</direction><length>0</length></line>"), "<line/length> is zero"),
    ],
)
def test_what_cannot_work_is_a_finding(tmp_path, plugin, why):
    twin = twin_of(tmp_path, "", robots={"sled": (box("sled", (1, 1, 1), mass=1, more=plugin), (0, 0, 0))})
    (finding,) = [item for item in twin.findings if item.kind is Kind.NOT_STARTED]
    assert finding.what.endswith(why)
    assert finding.lines == (4,)


@pytest.mark.parametrize(
    ("elements", "why"),
    [
        (WAY.format(1, "a"), "<waypoint> is '1 a', which is not two finite numbers"),
        (WAY.format(1, "2 3"), "<waypoint> is '1 2 3', which is not two finite numbers"),
        (WAY.format(1, 2) + "<range_tolerance>-1</range_tolerance>", "<range_tolerance> is -1, and has to be zero or"),
        ("<line><direction>x</direction><length>1</length></line>", "<line/direction> is 'x', which is not a number"),
    ],
)
def test_a_bad_value_is_refused_with_its_file_and_line(tmp_path, elements, why):
    with pytest.raises(InputError) as raised:
        sled(tmp_path, elements)
    assert f"sled.sdf:4: <plugin filename='gz-sim-trajectory-follower-system'>: {why}" in str(raised.value)


@pytest.mark.parametrize(
    ("values", "why"),
    [
        ({"waypoints": (1.0, 2.0, 3.0)}, "waypoints has an odd number of coordinates"),
        ({}, "there are no waypoints, no circle and no line"),
    ],
)
def test_bad_parameters_are_refused(values, why):
    with pytest.raises(ParameterError, match=why):
        TrajectoryFollowerParameters(link_name="l", **values)
