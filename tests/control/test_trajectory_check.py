import math

import pytest

from drake_twin.control.trajectory import TrajectoryPoint
from drake_twin.control.trajectory_check import TrajectoryRules, checked_trajectory
from drake_twin.errors import CommandError

RULES = TrajectoryRules(("a", "b"))


def check(rules=RULES, joints=("a", "b"), points=None, times=(1.0, 2.0), start=None, now=0.0):
    points = points or [TrajectoryPoint((0.0,) * len(joints))] * len(times)
    return checked_trajectory(rules, joints, points, times, start, now)


def test_a_trajectory_is_put_into_the_order_of_the_controllers_joints():
    point = TrajectoryPoint((1.0, 2.0), (3.0, 4.0), (5.0, 6.0))
    sorted_point = check(
        TrajectoryRules(("a", "b"), allow_nonzero_velocity_at_end=True), ("b", "a"), [point], (1.0,)
    ).points[0]
    assert sorted_point == TrajectoryPoint((2.0, 1.0), (4.0, 3.0), (6.0, 5.0))


def test_a_partial_trajectory_marks_the_joints_that_it_leaves_out():
    rules = TrajectoryRules(("a", "b", "c"), allow_partial_joints_goal=True)
    point = check(rules, ("c", "a"), [TrajectoryPoint((3.0, 1.0), (0.0, 0.0))], (1.0,)).points[0]
    assert math.isnan(point.positions[1])
    assert (point.positions[0], point.positions[2], point.velocities) == (1.0, 3.0, (0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"joints": ()}, "names no joints"),
        ({"points": [], "times": ()}, "has no points"),
        ({"joints": ("a", "bb")}, "the trajectory names an unknown joint 'bb'. Did you mean 'b'"),
        ({"joints": ("a", "a")}, "names the joint 'a' twice"),
        ({"joints": ("b",)}, "leaves out a, which only allow_partial_joints_goal permits"),
        ({"points": [TrajectoryPoint((0.0,))] * 2}, "point 0 of the trajectory has 1 positions for 2 joints: a, b"),
        ({"points": [TrajectoryPoint((0.0, 0.0), (0.0,))] * 2}, "has 1 velocities for 2 joints"),
        ({"points": [TrajectoryPoint((0.0, 0.0), (), (0.0,))] * 2}, "has 1 accelerations for 2 joints"),
        ({"points": [TrajectoryPoint((0.0, math.nan))] * 2}, "has nan among its positions, for joint b"),
        ({"times": (1.0, 1.0)}, "do not increase: point 0 is at 1 s, point 1 at 1 s"),
        ({"start": 3.0, "now": 5.1}, "ends in the past: it starts at 3 s and ends at 5 s, and it is 5.1 s"),
        ({"points": [TrajectoryPoint((0.0, 0.0), (0.0, 1e-6))] * 2}, "ends with a velocity of 1e-06 at joint b"),
        ({"points": [TrajectoryPoint((0.0, 0.0), (-0.1, 0.0))] * 2}, "ends with a velocity of -0.1 at joint a"),
        (
            {"points": [TrajectoryPoint(velocities=(0.0, 0.0))] * 2},
            "only allow_integration_in_goal_trajectories",
        ),
        (
            {"points": [TrajectoryPoint((0.0, 0.0), effort=(1.0, 1.0))] * 2},
            "efforts, but the controller does not command efforts",
        ),
    ],
)
def test_a_trajectory_that_upstream_rejects_is_refused_and_says_why(arguments, text):
    points = arguments.pop("points", None)
    times = arguments.pop("times", (1.0, 2.0))
    joints = arguments.pop("joints", ("a", "b"))
    if points is None:
        points = [TrajectoryPoint((0.0,) * len(joints))] * len(times)
    with pytest.raises(CommandError, match=text):
        checked_trajectory(RULES, joints, points, times, arguments.get("start"), arguments.get("now", 0.0))


def test_what_the_rules_permit_is_taken():
    rules = TrajectoryRules(("a", "b"), allow_integration=True, allow_nonzero_velocity_at_end=True, has_effort=True)
    points = [TrajectoryPoint(velocities=(1.0, 1.0), effort=(1.0, 0.0)), TrajectoryPoint(accelerations=(1.0, 1.0))]
    assert check(rules, points=points).points == tuple(points)
    with pytest.raises(CommandError, match="no positions, velocities or accelerations"):
        check(rules, points=[TrajectoryPoint()] * 2)


def test_a_start_in_the_past_is_taken_while_the_end_is_to_come():
    assert check(start=3.0, now=4.9).start == 3.0
