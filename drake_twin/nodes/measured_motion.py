"""What messages measure of a body's motion, as the Kalman filter of ``robot_localization`` takes it.

Source: cra-ros-pkg/robot_localization (ros2), preparePose, prepareTwist and prepareAcceleration of src/ros_filter.cpp.
"""

from collections.abc import Sequence
from math import inf

import numpy as np

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
    angles,
    rotation,
    wrapped,
)

Motion = tuple[np.ndarray, np.ndarray]  # a rotation, shape (3, 3), and a translation (m), shape (3,)
_LEAST = 1e-6  # of a rotated axis, below which it takes no part


class Source:
    """The poses, the twists or the accelerations of one topic.

    Args:
        name: The name of its parameters: ``odom0``.
        config: Which values of the state the topic is used for, shape (15,).
        parts: What of them its messages have here.
        threshold: The Mahalanobis distance from which they are ignored.
        is_differential: Whether poses are used as velocities.
        is_relative: Whether poses are relative to the first one.

    Attributes:
        is_used: Which values of the state are taken from it, shape (15,).
        last: The time of the last message (ns).
        first: The first pose, of which the others are relative.
        before: The pose, its covariance and its time (ns) before, of which the next one is a difference.
    """

    def __init__(
        self,
        name: str,
        config: Sequence[bool],
        parts: Sequence[slice],
        threshold: float = inf,
        *,
        is_differential: bool = False,
        is_relative: bool = False,
    ):
        self.name, self.threshold = name, threshold
        self.is_differential, self.is_relative = is_differential, is_relative
        self.is_used = np.zeros(SIZE, dtype=bool)
        for part in parts:
            self.is_used[part] = config[part]
        self.forget()

    def forget(self) -> None:
        """Forget what was measured."""
        self.last = -1
        self.first: Motion | None = None
        self.before: tuple[Motion, np.ndarray, int] | None = None

    def begin(self, time: int) -> Measurement | None:
        """Return an empty measurement at a time (ns); None if nothing is used, or it is older than the last one."""
        if not self.is_used.any() or time < self.last:
            return None
        self.last = time
        return Measurement(time, self.threshold)


def put_pose(
    measurement: Measurement, source: Source, frame: Motion, pose: Motion, covariance: np.ndarray, *, is_imu: bool
) -> bool:
    """Put a pose into a measurement, or the velocity since the pose before.

    Args:
        measurement: Gets it.
        source: Where it comes from.
        frame: The pose of the message's frame; of an IMU, which is the sensor's own, its mounting on the robot.
        pose: The pose in the message.
        covariance: Its covariance, shape (6, 6).
        is_imu: Whether an IMU measures it, against a frame of the world.

    Returns:
        Whether there is something: the first pose has no velocity.
    """
    R, offset = frame
    axes = rotation(0.0, 0.0, angles(R)[2]) if is_imu else R
    if is_imu:
        turned = axes @ wrapped(angles(pose[0]) - angles(R))
        pose, R, offset = (rotation(*turned), pose[1]), np.eye(3), np.zeros(3)
    used = np.concatenate([_rotated_axes(axes, source.is_used[part]) for part in (POSITION, ORIENTATION)])
    both = _of_both(axes)
    rotated = both @ covariance @ both.T
    if not source.is_differential:
        if source.is_relative:
            source.first = source.first or pose
            start = source.first[0].T
            pose = start @ pose[0], start @ (pose[1] - source.first[1])
        measurement.values[POSE] = np.concatenate((R @ pose[1] + offset, angles(R @ pose[0])))
        measurement.covariance[POSE, POSE], measurement.is_measured[POSE] = rotated, used
        return True
    before, source.before = source.before, (pose, covariance, measurement.time)
    if before is None or measurement.time == before[2]:
        return False
    dt = (measurement.time - before[2]) * 1e-9
    start = before[0][0].T
    moved, turned = R @ start @ (pose[1] - before[0][1]), angles(R @ start @ pose[0])
    measurement.values[TWIST] = np.concatenate((moved, turned)) / dt
    measurement.covariance[TWIST, TWIST] = (rotated + both @ before[1] @ both.T) * dt
    measurement.is_measured[TWIST] = used
    return True


def put_twist(
    measurement: Measurement, source: Source, frame: Motion, twist: np.ndarray, covariance: np.ndarray, turn: np.ndarray
) -> None:
    """Put a twist into a measurement.

    Args:
        measurement: Gets it.
        source: Where it comes from.
        frame: The pose of the message's frame on the robot.
        twist: The linear (m/s) and the angular velocity (rad/s), shape (6,).
        covariance: Its covariance, shape (6, 6).
        turn: The present angular velocity of the robot (rad/s).
    """
    R, offset = frame
    both = _of_both(R)
    measurement.values[TWIST] = both @ twist
    measurement.values[VELOCITY] += _cross(offset, turn)
    measurement.covariance[TWIST, TWIST] = both @ covariance @ both.T
    for part in (VELOCITY, TURN):
        measurement.is_measured[part] = _rotated_axes(R, source.is_used[part])


def put_acceleration(
    measurement: Measurement,
    source: Source,
    frame: Motion,
    acceleration: np.ndarray,
    covariance: np.ndarray,
    turn: tuple[np.ndarray, np.ndarray],
) -> None:
    """Put an acceleration into a measurement.

    Args:
        measurement: Gets it.
        source: Where it comes from.
        frame: The pose of the message's frame on the robot.
        acceleration: The acceleration (m/s²), shape (3,).
        covariance: Its covariance, shape (3, 3).
        turn: The present angular velocity of the robot (rad/s) and its angular acceleration (rad/s²).
    """
    R, offset = frame
    of_offset = _cross(offset, turn[1]) - _cross(_cross(offset, turn[0]), turn[0])
    measurement.values[ACCELERATION] = R @ acceleration + of_offset
    measurement.covariance[ACCELERATION, ACCELERATION] = R @ covariance @ R.T
    measurement.is_measured[ACCELERATION] = _rotated_axes(R, source.is_used[ACCELERATION])


def _of_both(R: np.ndarray) -> np.ndarray:
    """Return the rotation of two vectors at once, shape (6, 6)."""
    both = np.zeros((6, 6))
    both[:3, :3] = both[3:, 3:] = R
    return both


def _cross(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the cross product; `numpy.cross` takes ten times as long."""
    (a, b, c), (x, y, z) = one, other
    return np.array((b * z - c * y, c * x - a * z, a * y - b * x))


def _rotated_axes(R: np.ndarray, is_used: np.ndarray) -> np.ndarray:
    """Return which axes take part when some are used and then rotated."""
    axes = R * is_used
    return np.asarray((axes * axes).sum(axis=1) >= _LEAST**2)
