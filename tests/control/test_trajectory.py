import math

import numpy as np
import pytest
from scipy.integrate import trapezoid
from scipy.interpolate import BPoly, CubicHermiteSpline, make_interp_spline

from drake_twin.control.trajectory import Trajectory, TrajectoryPoint, interpolate, position_error, take_up

TIMES = (0.7, 1.1, 3.0, 3.2)
RNG = np.random.default_rng(7)
Q, V, A = (RNG.normal(size=(5, 3)) for _ in range(3))


def points(velocities=False, accelerations=False, effort=False):
    return tuple(
        TrajectoryPoint(
            tuple(Q[i]),
            tuple(V[i]) if velocities else (),
            tuple(A[i]) if accelerations else (),
            tuple(A[i]) if effort else (),
        )
        for i in range(5)
    )


def running(start=2.5, **fields):
    before, *rest = points(**fields)
    return take_up(Trajectory(tuple(rest), TIMES), start, before)


def deviation(trajectory, spline, start=2.5):
    """The largest difference of position, velocity and acceleration at 500 times, relative where they are above 1."""
    worst = 0.0
    for elapsed in np.linspace(0.0, TIMES[-1] - 1e-6, 500):
        point = trajectory.sample(start + elapsed).point
        for order, values in enumerate((point.positions, point.velocities, point.accelerations)):
            expected = spline(elapsed, order)
            worst = max(worst, np.max(np.abs(values - expected)) / max(1.0, np.max(np.abs(expected))))
    return worst


def test_positions_alone_are_interpolated_linearly_as_scipy_does():
    spline = make_interp_spline((0.0, *TIMES), Q, k=1)
    trajectory = running()
    for elapsed in np.linspace(0.0, 3.1999, 300):
        assert trajectory.sample(2.5 + elapsed).point.positions == pytest.approx(spline(elapsed), abs=1e-12)
    assert trajectory.sample(3.5).point.velocities == pytest.approx((Q[2] - Q[1]) / 0.4, abs=1e-12)


def test_positions_with_velocities_are_scipys_cubic_hermite_spline():
    assert deviation(running(velocities=True), CubicHermiteSpline((0.0, *TIMES), Q, V)) < 1e-12


def test_positions_velocities_and_accelerations_are_scipys_quintic():
    spline = BPoly.from_derivatives((0.0, *TIMES), np.stack([Q, V, A], axis=1))
    assert deviation(running(velocities=True, accelerations=True), spline) < 1e-12


def test_efforts_are_interpolated_linearly():
    trajectory = running(velocities=True, effort=True)
    assert trajectory.sample(2.5 + 2.0).point.effort == pytest.approx(A[2] + (A[3] - A[2]) * 0.9 / 1.9, abs=1e-12)


def test_positions_with_accelerations_but_without_velocities_do_not_jump_to_zero():
    point = interpolate(TrajectoryPoint((1.0,), (), (5.0,)), TrajectoryPoint((3.0,), (), (5.0,)), 2.0, 1.0)
    assert point.positions == (2.0,)


def test_after_the_last_point_it_stays_there_with_what_the_point_says():
    trajectory = running(velocities=True)
    sample = trajectory.sample(2.5 + 9.0)
    assert sample.is_over
    assert sample.time_since_point == pytest.approx(9.0 - TIMES[-1])
    assert sample.point.positions == tuple(Q[4])
    assert sample.point.velocities == tuple(V[4])
    assert sample.point.accelerations == (0.0, 0.0, 0.0)


def test_a_time_that_is_the_last_point_but_for_rounding_is_the_end():
    # 0.58 − 0.01 < 0.57, as many a difference of multiples of a period.
    missed = 0
    for start in range(1, 60):
        for duration in range(1, 60):
            message = Trajectory((TrajectoryPoint((1.0,)),), (duration * 0.01,))
            trajectory = take_up(message, start * 0.01, TrajectoryPoint((0.0,)))
            end = (start + duration) * 0.01
            missed += end - start * 0.01 < duration * 0.01
            assert trajectory.sample(end).is_over
            assert not trajectory.sample(end - 1e-8).is_over
    assert missed > 0


def test_it_moves_towards_the_first_point_before_the_start_that_it_was_given():
    message = Trajectory((TrajectoryPoint((2.0,)), TrajectoryPoint((3.0,))), (1.0, 9.0), start=5.0)
    trajectory = take_up(message, 2.0, TrajectoryPoint((0.0,)))
    sample = trajectory.sample(4.0)
    assert sample.point.positions == (1.0,)
    assert sample.time_since_point == pytest.approx(-2.0)


def test_a_trajectory_that_has_started_already_is_entered_in_its_midst():
    message = Trajectory((TrajectoryPoint((0.0,)), TrajectoryPoint((1.0,))), (0.0, 1.0), start=1.0)
    assert take_up(message, 1.25, TrajectoryPoint((9.0,))).sample(1.25).point.positions == (0.25,)


def test_a_state_without_velocity_begins_at_rest_where_the_points_have_velocities():
    trajectory = take_up(Trajectory((TrajectoryPoint((1.0,), (0.0,)),), (2.0,)), 0.0, TrajectoryPoint((0.0,)))
    assert trajectory.sample(0.5).point.positions == pytest.approx(
        [float(CubicHermiteSpline([0, 2], [0, 1], [0, 0])(0.5))]
    )


def test_without_interpolation_the_next_point_is_the_set_point():
    message = Trajectory((TrajectoryPoint((1.0,)), TrajectoryPoint((2.0,)), TrajectoryPoint((3.0,))), (1.0, 2.0, 3.0))
    trajectory = take_up(message, 0.0, TrajectoryPoint((0.5,)), interpolation_method="none")
    assert [trajectory.sample(t).point.positions[0] for t in (0.5, 1.0, 1.9, 2.0, 3.5)] == [0.5, 2.0, 2.0, 3.0, 3.0]


def test_positions_are_the_integral_of_velocities_where_only_these_are_given():
    velocities = (1.0, -0.5, 0.0)
    message = Trajectory(tuple(TrajectoryPoint(velocities=(v,)) for v in velocities), (1.0, 1.5, 3.0))
    trajectory = take_up(message, 10.0, TrajectoryPoint((0.3,), (0.2,)))
    times = np.linspace(0.0, 3.0, 30_001)
    velocity = np.interp(times, (0.0, 1.0, 1.5, 3.0), (0.2, *velocities))
    for time in (0.4, 1.0, 1.3, 2.2, 3.0):
        expected = 0.3 + trapezoid(np.where(times <= time, velocity, 0.0), times)
        point = trajectory.sample(10.0 + time).point
        assert point.positions[0] == pytest.approx(expected, abs=1e-4)
        assert point.velocities[0] == pytest.approx(np.interp(time, times, velocity), abs=1e-9)


def test_velocities_are_the_integral_of_accelerations_where_only_these_are_given():
    message = Trajectory(tuple(TrajectoryPoint(accelerations=(a,)) for a in (2.0, -2.0)), (1.0, 2.0))
    trajectory = take_up(message, 0.0, TrajectoryPoint((0.0,), (0.0,)))
    last = trajectory.sample(2.0).point
    assert last.velocities == (1.0,)  # (0 + 2)/2 · 1, then (2 − 2)/2 · 1
    assert last.positions == (1.5,)  # 0.5 · (0 + 1), then 0.5 · (1 + 1)


def test_a_joint_that_wraps_around_goes_the_short_way():
    message = Trajectory((TrajectoryPoint((-3.0, -3.0)),), (1.0,))
    trajectory = take_up(message, 0.0, TrajectoryPoint((3.0, 3.0)), wraparound=(True, False))
    middle = trajectory.sample(0.5).point.positions
    assert middle[0] == pytest.approx(-math.pi, abs=1e-12)
    assert middle[1] == 0.0
    assert trajectory.turns == pytest.approx((2 * math.pi, 0.0))


def test_half_a_turn_goes_towards_the_number_of_the_goal():
    for goal in (math.pi, -math.pi):
        trajectory = take_up(Trajectory((TrajectoryPoint((goal,)),), (1.0,)), 0.0, TrajectoryPoint((0.0,)), (True,))
        assert trajectory.sample(0.5).point.positions[0] == pytest.approx(goal / 2)


def test_the_error_of_a_joint_that_wraps_around_is_the_short_way():
    desired, actual = (3.0, 3.0, 0.1), (-3.0, -3.0, 36_000 * math.pi)
    assert position_error(desired, actual, (True, False, True)) == pytest.approx((6 - 2 * math.pi, 6, 0.1))


def test_joints_that_a_message_left_out_stand_still():
    trajectory = Trajectory(
        (TrajectoryPoint((math.nan, 1.0), (0.0, 0.0)), TrajectoryPoint(velocities=(0.0, 1.0))), (1, 2)
    )
    filled = trajectory.with_missing_positions((0.25, 9.0))
    assert filled.points[0].positions == (0.25, 1.0)
    assert filled.points[1] == trajectory.points[1]
