import pytest

from drake_twin.control.tolerances import StateTolerance, Tolerances, goal_tolerances, violation
from drake_twin.control.trajectory import TrajectoryPoint
from drake_twin.errors import CommandError

JOINTS = ("a", "b")
DEFAULTS = Tolerances((StateTolerance(0.1), StateTolerance(0.2)), (StateTolerance(0.01, 0.01),) * 2, 0.5)


def test_a_goal_that_names_no_tolerances_has_the_controllers_own():
    assert goal_tolerances(DEFAULTS, JOINTS, {}, {}, 0.0) == DEFAULTS


def test_zero_leaves_a_tolerance_and_minus_one_takes_it_away():
    merged = goal_tolerances(
        DEFAULTS, JOINTS, {"b": StateTolerance(-1.0, 0.3)}, {"a": StateTolerance(0.0, -1.0, 2.0)}, -1.0
    )
    assert merged.path == (StateTolerance(0.1), StateTolerance(0.0, 0.3))
    assert merged.goal == (StateTolerance(0.01, 0.0, 2.0), StateTolerance(0.01, 0.01))
    assert merged.goal_time == 0.0


def test_a_goals_own_tolerances_in_any_order_of_joints():
    """test_tolerances.cpp:84-160: three joints, the goal's in another order."""
    joints = ("joint1", "joint2", "joint3")
    defaults = Tolerances((StateTolerance(0.1),) * 3, (StateTolerance(0.1, 0.1),) * 3, 0.1)
    path = dict.fromkeys(joints, StateTolerance(0.2, 0.3, 0.4))
    goal = {f"joint{i}": StateTolerance(1 + i / 10, 2 + i / 10, 3 + i / 10) for i in (2, 3, 1)}
    merged = goal_tolerances(defaults, joints, path, goal, 2.0)
    assert merged == Tolerances((StateTolerance(0.2, 0.3, 0.4),) * 3, tuple(goal[joint] for joint in joints), 2.0)
    erased = dict.fromkeys(joints, StateTolerance(-1.0, -1.0, -1.0))  # test_tolerances.cpp:162-220
    assert goal_tolerances(defaults, joints, erased, erased, -1.0) == Tolerances(
        (StateTolerance(),) * 3, (StateTolerance(),) * 3, 0.0
    )


@pytest.mark.parametrize(
    ("path", "goal", "time", "text"),
    [
        ({"c": StateTolerance()}, {}, 0.0, "path_tolerance names an unknown joint 'c'"),
        ({}, {"a": StateTolerance(velocity=-0.5)}, 0.0, "goal_tolerance of joint a is -0.5; 0 means the default"),
        ({}, {}, -2.0, "goal_time_tolerance is -2"),
    ],
)
def test_tolerances_without_meaning_are_refused(path, goal, time, text):
    with pytest.raises(CommandError, match=text):
        goal_tolerances(DEFAULTS, JOINTS, path, goal, time)


def test_a_violation_names_joint_error_and_tolerance():
    error = TrajectoryPoint((0.05, -0.3), (0.0, 0.0))
    assert violation(JOINTS, error, DEFAULTS.path) == "the position error of joint b is -0.3, its tolerance 0.2"


def test_zero_is_no_tolerance_and_an_error_that_equals_its_tolerance_is_within():
    assert violation(JOINTS, TrajectoryPoint((9.0, 0.2)), (StateTolerance(), StateTolerance(0.2))) is None


def test_velocities_are_judged_where_they_are_measured():
    tolerances = (StateTolerance(velocity=0.01),) * 2
    assert violation(JOINTS, TrajectoryPoint((0.0, 0.0)), tolerances) is None
    text = violation(JOINTS, TrajectoryPoint((0.0, 0.0), (0.0, 0.02)), tolerances)
    assert text == "the velocity error of joint b is 0.02, its tolerance 0.01"
