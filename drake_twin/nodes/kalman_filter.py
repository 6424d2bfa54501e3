"""The extended Kalman filter of ``robot_localization``, for the program ``ekf_node``.

Source: T. Moore, D. Stouch: A Generalized Extended Kalman Filter Implementation for the Robot Operating System (2014),
and cra-ros-pkg/robot_localization (ros2), src/ekf.cpp and src/filter_base.cpp.
"""

from math import cos, inf, pi, sin, tan

import numpy as np

# Slices of the state: x, y, z (m); roll, pitch, yaw (rad); velocities (m/s), turns (rad/s) and accelerations (m/s²) of
# the body.
POSITION, ORIENTATION, VELOCITY, TURN, ACCELERATION = (slice(first, first + 3) for first in range(0, 15, 3))
POSE, TWIST = slice(0, 6), slice(6, 12)
SIZE = 15

_PROCESS_NOISE = (0.05, 0.05, 0.06, 0.03, 0.03, 0.06, 0.025, 0.025, 0.04, 0.01, 0.01, 0.02, 0.01, 0.01, 0.015)
_LEAST_VARIANCE = 1e-9
# What `two_d_mode` takes to be measured as zero: z, roll and pitch, with their velocities, and the acceleration in z.
_NOT_PLANAR = (2, 3, 4, 8, 9, 10, 14)
_PLANAR_VARIANCE = 1e-6


class Measurement:
    """Values of the state that were measured.

    Args:
        time: When (ns).
        threshold: The Mahalanobis distance (standard deviations) from which they are ignored.

    Attributes:
        values: The values, shape (15,).
        covariance: Their covariance, shape (15, 15).
        is_measured: Which of them are measured, shape (15,).
    """

    def __init__(self, time: int, threshold: float = inf):
        self.time, self.threshold = time, threshold
        self.values = np.zeros(SIZE)
        self.covariance = np.zeros((SIZE, SIZE))
        self.is_measured = np.zeros(SIZE, dtype=bool)

    def flatten(self) -> None:
        """Take the robot to be in a plane."""
        for index in _NOT_PLANAR:
            self.values[index], self.covariance[index, index] = 0.0, _PLANAR_VARIANCE
            self.is_measured[index] = True


class KalmanFilter:
    """An estimate of a body's motion in three dimensions, with constant accelerations.

    Attributes:
        state: The estimate, shape (15,), see `POSITION` and the others.
        covariance: Its covariance, shape (15, 15).
        process_noise: What is added to it in a second.
        is_dynamic: Whether the noise of the pose grows with the speed.
        time: The time of the estimate (ns).
        has_begun: Whether there was a measurement.
    """

    def __init__(self) -> None:
        self.state = np.zeros(SIZE)
        self.covariance = _LEAST_VARIANCE * np.eye(SIZE)
        self.process_noise = np.diag(_PROCESS_NOISE)
        self.is_dynamic = False
        self.time = 0
        self.has_begun = False

    def process(self, measurement: Measurement) -> None:
        """Take a measurement: the first is the estimate, a late one corrects the present estimate."""
        if not self.has_begun:
            used = measurement.is_measured
            self.state[used] = measurement.values[used]
            both = np.outer(used, used)
            self.covariance[both] = measurement.covariance[both]
            self.has_begun, self.time = True, measurement.time
            return
        if measurement.time > self.time:
            self.predict(measurement.time)
        self.correct(measurement)

    def predict(self, time: int) -> None:
        """Move the estimate to a time (ns)."""
        dt, self.time = (time - self.time) * 1e-9, time
        roll, pitch, yaw = self.state[ORIENTATION]
        turn, move = self.state[TURN], self.state[VELOCITY] * dt + 0.5 * self.state[ACCELERATION] * dt * dt
        R, rates = rotation(roll, pitch, yaw), _rates(roll, pitch)
        transfer = np.eye(SIZE)
        transfer[POSITION, VELOCITY], transfer[POSITION, ACCELERATION] = R * dt, 0.5 * R * dt * dt
        transfer[ORIENTATION, TURN], transfer[VELOCITY, ACCELERATION] = rates * dt, np.eye(3) * dt
        jacobian = transfer.copy()
        (x, y, z), cy, sy = R @ move, cos(yaw), sin(yaw)
        jacobian[POSITION, 3] = R @ (0.0, -move[2], move[1])
        jacobian[POSITION, 4] = cy * z, sy * z, -cy * x - sy * y
        jacobian[POSITION, 5] = -y, x, 0.0
        by_roll, by_pitch = _rate_changes(roll, pitch)
        jacobian[ORIENTATION, 3] += by_roll @ turn * dt
        jacobian[ORIENTATION, 4] += by_pitch @ turn * dt
        noise = self.process_noise
        if self.is_dynamic:
            noise = noise.copy()
            noise[POSE, POSE] *= float(self.state[TWIST] @ self.state[TWIST])
        self.state = transfer @ self.state
        self._wrap()
        self.covariance = jacobian @ self.covariance @ jacobian.T + dt * noise

    def correct(self, measurement: Measurement) -> None:
        """Correct the estimate, unless the measurement is too far from it."""
        used = np.flatnonzero(measurement.is_measured & np.isfinite(measurement.values))
        R = measurement.covariance[np.ix_(used, used)].copy()
        np.fill_diagonal(R, np.maximum(np.abs(np.diag(R)), _LEAST_VARIANCE))
        innovation = measurement.values[used] - self.state[used]
        turns = (used >= ORIENTATION.start) & (used < ORIENTATION.stop)
        innovation[turns] = wrapped(innovation[turns])
        precision = np.linalg.inv(self.covariance[np.ix_(used, used)] + R)
        if innovation @ precision @ innovation >= measurement.threshold**2:
            return
        gain = self.covariance[:, used] @ precision
        self.state = self.state + gain @ innovation
        left = np.eye(SIZE)
        left[:, used] -= gain
        self.covariance = left @ self.covariance @ left.T + gain @ R @ gain.T
        self._wrap()

    def _wrap(self) -> None:
        self.state[ORIENTATION] = wrapped(self.state[ORIENTATION])


def wrapped(angles: np.ndarray) -> np.ndarray:
    """Return angles (rad) between -π and π."""
    return (np.asarray(angles) + pi) % (2.0 * pi) - pi


def rotation(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """Return the rotation matrix of angles (rad) about fixed axes, shape (3, 3)."""
    cr, sr, cp, sp, cy, sy = cos(roll), sin(roll), cos(pitch), sin(pitch), cos(yaw), sin(yaw)
    return np.array(
        (
            (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
            (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
            (-sp, cp * sr, cp * cr),
        )
    )


def angles(R: np.ndarray) -> np.ndarray:
    """Return roll, pitch, yaw (rad) of a rotation matrix, shape (3,)."""
    level = np.hypot(R[0, 0], R[1, 0])
    if level < 1e-9:  # the x axis is vertical: roll and yaw turn about one axis
        return np.array((0.0, np.arctan2(-R[2, 0], level), np.arctan2(-R[0, 1], R[1, 1])))
    return np.array((np.arctan2(R[2, 1], R[2, 2]), np.arctan2(-R[2, 0], level), np.arctan2(R[1, 0], R[0, 0])))


def _rates(roll: float, pitch: float) -> np.ndarray:
    """Return what makes rates of roll, pitch, yaw of an angular velocity in the body."""
    cr, sr, t, c = cos(roll), sin(roll), tan(pitch), cos(pitch)
    return np.array(((1.0, sr * t, cr * t), (0.0, cr, -sr), (0.0, sr / c, cr / c)))


def _rate_changes(roll: float, pitch: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the derivatives of `_rates` by roll and by pitch."""
    cr, sr, t, c = cos(roll), sin(roll), tan(pitch), cos(pitch)
    by_roll = np.array(((0.0, cr * t, -sr * t), (0.0, -sr, -cr), (0.0, cr / c, -sr / c)))
    by_pitch = np.array(((0.0, sr / c**2, cr / c**2), (0.0, 0.0, 0.0), (0.0, sr * t / c, cr * t / c)))
    return by_roll, by_pitch
