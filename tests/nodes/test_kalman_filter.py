"""The filter of robot_localization, against its own test, numerical derivatives and a plain filter of one axis."""

from math import pi

import numpy as np
import pytest

from drake_twin.nodes.kalman_filter import (
    ACCELERATION,
    ORIENTATION,
    POSITION,
    SIZE,
    TURN,
    TWIST,
    VELOCITY,
    KalmanFilter,
    Measurement,
    angles,
    rotation,
    wrapped,
)

SECOND = 1_000_000_000


def measured(values, variance=1e-9, time=0, **more):
    measurement = Measurement(time, **more)
    for index, value in values.items():
        measurement.values[index], measurement.is_measured[index] = value, True
        measurement.covariance[index, index] = variance
    return measurement


def test_measurements_as_in_upstreams_test():
    """``EkfTest.Measurements`` of test/test_ekf.cpp."""
    own = KalmanFilter()
    own.covariance = 0.5 * np.eye(SIZE)
    values = {index: index * 0.01 * SIZE for index in range(SIZE)}
    own.process(measured(values, time=1000))
    assert own.state == pytest.approx(list(values.values()), abs=0)
    assert own.covariance == pytest.approx(1e-9 * np.eye(SIZE), abs=0)
    own.covariance = 0.5 * np.eye(SIZE)
    twice = {index: 2 * value for index, value in values.items()}
    own.process(measured(twice, time=1002))
    expected = np.array(list(twice.values()))
    expected[ORIENTATION] = wrapped(expected[ORIENTATION])
    assert own.state == pytest.approx(expected, abs=1e-3)


def test_the_covariance_follows_the_numerical_derivatives():
    rng = np.random.default_rng(7)
    dt, start = 0.1, rng.normal(scale=0.5, size=SIZE)

    def moved(state):
        own = KalmanFilter()
        own.state = state.copy()
        own.predict(round(dt * SECOND))
        return own.state

    step = 1e-6
    J = np.array([(moved(start + step * row) - moved(start - step * row)) / (2 * step) for row in np.eye(SIZE)]).T
    A = rng.normal(size=(SIZE, SIZE))
    own = KalmanFilter()
    own.state, own.covariance = start.copy(), A @ A.T
    own.predict(round(dt * SECOND))
    assert own.covariance == pytest.approx(J @ A @ A.T @ J.T + dt * own.process_noise, abs=1e-6)


def test_a_straight_and_a_circle():
    own = KalmanFilter()
    own.state[VELOCITY], own.state[ACCELERATION] = (1.0, 0.0, 0.0), (0.5, 0.0, 0.0)
    own.predict(2 * SECOND)
    assert own.state[POSITION] == pytest.approx((2.0 + 0.5 * 0.5 * 4.0, 0.0, 0.0))
    assert own.state[VELOCITY] == pytest.approx((2.0, 0.0, 0.0))
    circle = KalmanFilter()
    circle.state[VELOCITY], circle.state[TURN] = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    for step in range(1, 1001):  # a half circle of radius 1
        circle.predict(round(step * pi * 1e-3 * SECOND))
    assert circle.state[POSITION] == pytest.approx((0.0, 2.0, 0.0), abs=5e-3)
    assert abs(circle.state[ORIENTATION][2]) == pytest.approx(pi, abs=1e-6)


def test_one_axis_is_a_plain_filter():
    """x, vx and ax with measurements of vx, in the notation of a textbook."""
    rng = np.random.default_rng(3)
    own = KalmanFilter()
    own.process(measured({6: 0.3}, 0.04))
    x, P, Q = np.array((0.0, 0.3, 0.0)), np.diag((1e-9, 0.04, 1e-9)), np.diag((0.05, 0.025, 0.01))
    H, dt = np.array(((0.0, 1.0, 0.0),)), 0.05
    F = np.array(((1.0, dt, dt * dt / 2), (0.0, 1.0, dt), (0.0, 0.0, 1.0)))
    for index in range(1, 60):
        z = 0.3 + 0.2 * rng.normal()
        own.process(measured({6: z}, 0.04, round(index * dt * SECOND)))
        x, P = F @ x, F @ P @ F.T + dt * Q
        K = P @ H.T / (H @ P @ H.T + 0.04)
        x, P = x + K[:, 0] * (z - x[1]), (np.eye(3) - K @ H) @ P
    axis = [0, 6, 12]
    assert own.state[axis] == pytest.approx(x, rel=1e-9)
    assert own.covariance[np.ix_(axis, axis)] == pytest.approx(P, rel=1e-7, abs=1e-12)


def test_a_measurement_that_is_too_far_is_ignored():
    own = KalmanFilter()
    own.process(measured({0: 0.0}, 1.0))
    own.process(measured({0: 9.0}, 1.0, threshold=5.0))
    assert own.state[0] == 0.0
    own.process(measured({0: 1.0}, 1.0, threshold=5.0))
    assert own.state[0] == pytest.approx(0.5)


def test_an_angle_is_corrected_on_the_short_way_and_nan_is_left_out():
    own = KalmanFilter()
    own.process(measured({5: 3.0}, 1.0))
    own.process(measured({5: -3.0, 0: np.nan}, 1.0))
    assert abs(own.state[5]) == pytest.approx(pi)
    assert own.state[0] == 0.0


def test_a_late_measurement_corrects_the_present():
    own = KalmanFilter()
    own.process(measured({0: 0.0, 6: 1.0}, 0.01, SECOND))
    own.process(measured({0: 0.0}, 0.01, SECOND // 2))
    assert own.time == SECOND
    assert own.state[6] == 1.0


def test_dynamic_noise_grows_with_the_square_of_the_speed():
    found = []
    for speed in (0.0, 2.0):
        own = KalmanFilter()
        own.is_dynamic, own.covariance = True, np.zeros((SIZE, SIZE))
        own.state[TWIST] = (speed, 0, 0, 0, 0, 0)
        own.predict(SECOND)
        found.append(own.covariance[0, 0])
    assert found == pytest.approx([0.0, 4.0 * 0.05])


def test_in_a_plane_nothing_leaves_it():
    measurement = measured({2: 5.0, 6: 1.0}, 0.5)
    measurement.flatten()
    assert np.flatnonzero(measurement.is_measured).tolist() == [2, 3, 4, 6, 8, 9, 10, 14]
    assert (measurement.values[2], measurement.covariance[2, 2], measurement.values[6]) == (0.0, 1e-6, 1.0)


@pytest.mark.parametrize("turned", [(0.3, -0.7, 2.0), (0.0, 0.0, -3.0), (0.0, pi / 2, 0.4)])
def test_angles_are_those_of_their_rotation(turned):
    assert rotation(*angles(rotation(*turned))) == pytest.approx(rotation(*turned))
