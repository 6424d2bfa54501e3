"""What messages measure, by geometry."""

from math import pi

import numpy as np
import pytest

from drake_twin.nodes.kalman_filter import (
    ACCELERATION,
    ORIENTATION,
    POSE,
    POSITION,
    SIZE,
    TURN,
    TWIST,
    VELOCITY,
    Measurement,
    rotation,
)
from drake_twin.nodes.measured_motion import Source, put_acceleration, put_pose, put_twist

SECOND = 1_000_000_000
ALL = [True] * SIZE
STILL = np.eye(3), np.zeros(3)
AT_SIDE = rotation(0.0, 0.0, pi / 2), np.array((1.0, 0.0, 0.0))  # a sensor that looks to the left, 1 m ahead


def only(*indices):
    return [index in indices for index in range(SIZE)]


def test_a_twist_is_turned_to_the_robot_and_freed_of_its_lever():
    """The sensor sees 2 m/s ahead, which is the robot's left; 3 rad/s at 1 m make 3 m/s of its own."""
    measurement, source = Measurement(0), Source("twist0", ALL, (VELOCITY, TURN))
    covariance = np.diag((1.0, 2.0, 3.0, 4.0, 5.0, 6.0))
    twist = np.array((2.0, 0.0, 0.0, 0.0, 0.5, 3.0))
    put_twist(measurement, source, AT_SIDE, twist, covariance, np.array((0.0, 0.0, 3.0)))
    assert measurement.values[TWIST] == pytest.approx((0.0, 2.0 - 3.0, 0.0, -0.5, 0.0, 3.0))
    assert np.diag(measurement.covariance)[TWIST] == pytest.approx((2.0, 1.0, 3.0, 5.0, 4.0, 6.0))


def test_what_is_used_is_turned_too():
    measurement, source = Measurement(0), Source("twist0", only(6, 11), (VELOCITY, TURN))
    put_twist(measurement, source, AT_SIDE, np.zeros(6), np.eye(6), np.zeros(3))
    assert np.flatnonzero(measurement.is_measured).tolist() == [7, 11]


def test_a_pose_in_another_frame():
    measurement, source = Measurement(0), Source("pose0", ALL, (POSITION, ORIENTATION))
    pose = rotation(0.0, 0.0, 0.1), np.array((1.0, 2.0, 0.0))
    assert put_pose(measurement, source, AT_SIDE, pose, np.eye(6), is_imu=False)
    assert measurement.values[POSE] == pytest.approx((-2.0 + 1.0, 1.0, 0.0, 0.0, 0.0, pi / 2 + 0.1))


def test_relative_poses_begin_at_zero():
    source = Source("pose0", ALL, (POSITION, ORIENTATION), is_relative=True)
    first = rotation(0.0, 0.0, pi / 2), np.array((5.0, 5.0, 0.0))
    then = rotation(0.0, 0.0, pi), np.array((5.0, 7.0, 0.0))
    for pose, expected in ((first, (0, 0, 0, 0, 0, 0)), (then, (2.0, 0, 0, 0, 0, pi / 2))):
        measurement = Measurement(0)
        assert put_pose(measurement, source, STILL, pose, np.eye(6), is_imu=False)
        assert measurement.values[POSE] == pytest.approx(expected, abs=1e-12)


def test_differences_of_poses_are_velocities():
    source = Source("pose0", only(0, 1, 5), (POSITION, ORIENTATION), is_differential=True)
    first = rotation(0.0, 0.0, pi / 2), np.array((5.0, 5.0, 0.0))
    then = rotation(0.0, 0.0, pi / 2 + 0.2), np.array((5.0, 6.0, 0.0))
    assert not put_pose(Measurement(0), source, STILL, first, np.eye(6), is_imu=False)
    measurement = Measurement(SECOND // 2)
    assert put_pose(measurement, source, STILL, then, np.eye(6), is_imu=False)
    assert measurement.values[TWIST] == pytest.approx((2.0, 0.0, 0.0, 0.0, 0.0, 0.4))
    assert np.flatnonzero(measurement.is_measured).tolist() == [6, 7, 11]
    assert measurement.covariance[6, 6] == pytest.approx(2.0 * 0.5)


def test_the_mounting_of_an_imu_is_taken_off():
    """A sensor that is mounted with its pitch on the robot's roll."""
    source = Source("imu0", ALL, (ORIENTATION,))
    robot = rotation(0.2, 0.0, 0.7)
    measurement = Measurement(0)
    assert put_pose(measurement, source, AT_SIDE, (robot @ AT_SIDE[0], np.zeros(3)), np.eye(6), is_imu=True)
    assert measurement.values[ORIENTATION] == pytest.approx((0.2, 0.0, 0.7))
    assert np.flatnonzero(measurement.is_measured).tolist() == [3, 4, 5]


def test_an_acceleration_is_freed_of_its_lever():
    """At 1 m from the axis, 3 rad/s pull with 9 m/s² to it, and 2 rad/s² push with 2 m/s²."""
    measurement, source = Measurement(0), Source("imu0", ALL, (ACCELERATION,))
    turn, sped_up = np.array((0.0, 0.0, 3.0)), np.array((0.0, 0.0, 2.0))
    felt = AT_SIDE[0].T @ np.array((-9.0, 2.0, 0.0))
    put_acceleration(measurement, source, AT_SIDE, felt, np.eye(3), (turn, sped_up))
    assert measurement.values[ACCELERATION] == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)


def test_old_and_unused_messages_are_no_measurements():
    source = Source("odom0", only(0), (POSITION,), threshold=3.0)
    assert source.begin(5).threshold == 3.0
    assert source.begin(5) is not None
    assert source.begin(4) is None
    source.forget()
    assert source.begin(4) is not None
    assert Source("odom0", only(6), (POSITION,)).begin(0) is None
