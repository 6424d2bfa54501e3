import pytest

from drake_twin.control.stop_trajectory import hold_trajectory, stop_trajectory
from drake_twin.control.trajectory import TrajectoryPoint, take_up


def test_each_joint_is_braked_with_its_own_deceleration():
    state = TrajectoryPoint((1.0, -1.0, 0.5), (2.0, -1.0, 0.0))
    running = take_up(stop_trajectory(state.positions, state.velocities, (4.0, 1.0, 1.0)), 7.0, state)
    for elapsed in (0.0, 0.2, 0.4, 0.5, 0.8, 1.0, 3.0):
        t0, t1 = min(elapsed, 0.5), min(elapsed, 1.0)
        point = running.sample(7.0 + elapsed).point
        assert point.positions == pytest.approx((1.0 + 2.0 * t0 - 2.0 * t0**2, -1.0 - t1 + 0.5 * t1**2, 0.5), abs=1e-12)
        assert point.velocities == pytest.approx((2.0 - 4.0 * t0, -1.0 + t1, 0.0), abs=1e-12)


def test_a_hold_is_over_at_once():
    state = TrajectoryPoint((1.0, 2.0), (3.0, 4.0))
    sample = take_up(hold_trajectory(state.positions), 7.0, state).sample(7.0)
    assert sample.is_over
    assert sample.point == TrajectoryPoint((1.0, 2.0), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0))
