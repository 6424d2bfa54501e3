from math import cos, pi, sin

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drake_twin.control.wheel_odometry import WheelOdometry, integrate_by_midpoint, integrate_exactly


def test_a_quarter_circle_in_one_step_ends_where_geometry_says():
    # radius 2: from the origin facing x, a quarter to the left ends at (2, 2) facing y
    assert integrate_exactly(0.0, 0.0, 0.0, pi, pi / 2) == pytest.approx((2.0, 2.0, pi / 2), abs=1e-15)


def test_exact_integration_does_not_depend_on_the_number_of_steps():
    pose = (0.3, -0.2, 0.7)
    for _ in range(1000):
        pose = integrate_exactly(*pose, 0.003, -0.004)
    assert pose == pytest.approx(integrate_exactly(0.3, -0.2, 0.7, 3.0, -4.0), abs=1e-12)


def test_a_turn_on_the_spot_does_not_move_the_base():
    assert integrate_exactly(1.0, 2.0, 0.5, 0.0, 3.0) == (1.0, 2.0, 3.5)


@pytest.mark.parametrize("turn", [0.0, 5e-7, -5e-7])
def test_along_almost_straight_lines_the_midpoint_is_used(turn):
    x, y, heading = integrate_exactly(0.0, 0.0, 0.3, 2.0, turn)
    assert (x, y, heading) == integrate_by_midpoint(0.0, 0.0, 0.3, 2.0, turn)
    assert (x, y) == pytest.approx((2 * cos(0.3), 2 * sin(0.3)), abs=1e-6)


def test_an_arc_of_many_steps_is_the_solution_of_the_equations_of_motion():
    linear, angular = 0.7, -0.9
    solution = solve_ivp(
        lambda _, pose: [linear * cos(pose[2]), linear * sin(pose[2]), angular],
        (0, 3),
        [0, 0, 0],
        rtol=1e-11,
        atol=1e-12,
    )
    odometry = WheelOdometry()
    for step in range(1, 301):
        odometry = odometry.moved(linear, angular, 0.01 * step, window=10)
    np.testing.assert_allclose([odometry.x, odometry.y, odometry.heading], solution.y[:, -1], atol=1e-9)


def test_the_velocity_is_the_mean_of_the_last_ones():
    odometry = WheelOdometry()
    for step, linear in enumerate([1.0, 2.0, 3.0, 6.0], start=1):
        odometry = odometry.moved(linear, -linear, 0.1 * step, window=3)
    assert (odometry.linear_x, odometry.angular_z) == pytest.approx((11 / 3, -11 / 3))


def test_the_position_is_not_averaged():
    odometry = WheelOdometry().moved(1.0, 0.0, 1.0, window=10).moved(3.0, 0.0, 2.0, window=10)
    assert (odometry.x, odometry.linear_x) == (4.0, 2.0)


def test_steps_of_less_than_a_tenth_of_a_millisecond_wait_for_more_time():
    odometry = WheelOdometry(time=1.0)
    assert odometry.moved(1.0, 1.0, 1.00005) is odometry
    assert odometry.moved(1.0, 0.0, 1.5).x == 0.5


def test_open_loop_reports_the_command_as_it_is():
    odometry = WheelOdometry().moved_open_loop(2.0, 0.0, 0.5).moved_open_loop(0.0, 1.0, 1.0)
    assert (odometry.x, odometry.heading, odometry.linear_x, odometry.angular_z) == (1.0, 0.5, 0.0, 1.0)


def test_a_base_that_moves_sideways_turns_first_and_then_moves():
    odometry = WheelOdometry().moved_sideways_too(1.0, 0.5, pi / 2, 1.0)
    assert (odometry.x, odometry.y, odometry.heading) == pytest.approx((-0.5, 1.0, pi / 2))


def test_moving_sideways_in_a_circle_comes_to_the_analytic_circle_as_steps_get_smaller():
    def error(steps):
        odometry = WheelOdometry()
        for step in range(1, steps + 1):
            odometry = odometry.moved_sideways_too(0.0, 1.0, 1.0, step / steps)
        # facing x and moving to the left while turning left: about (-1, 0)
        return np.hypot(odometry.x - (cos(1.0) - 1.0), odometry.y - sin(1.0))

    assert error(100) < 6e-3
    assert error(1000) == pytest.approx(error(100) / 10, rel=0.05)


def test_reset_keeps_time_and_velocity():
    odometry = WheelOdometry().moved(1.0, 1.0, 1.0).reset()
    assert (odometry.x, odometry.y, odometry.heading, odometry.time, odometry.linear_x) == (0.0, 0.0, 0.0, 1.0, 1.0)
