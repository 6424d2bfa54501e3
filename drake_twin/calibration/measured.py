"""What of a message is compared: its numbers by name, the same for messages of a log and of a twin.

| type | names |
|---|---|
| ``sensor_msgs/msg/JointState`` | ``JOINT.position``, ``JOINT.velocity``, ``JOINT.effort`` |
| ``nav_msgs/msg/Odometry`` | ``x``, ``y``, ``z``, ``roll``, ``pitch``, ``yaw``, ``linear.x`` …, ``angular.z`` |
| poses | ``x``, ``y``, ``z``, ``roll``, ``pitch``, ``yaw`` |
| twists | ``linear.x`` … ``angular.z`` |
| ``sensor_msgs/msg/Imu`` | ``angular.x`` …, ``acceleration.x`` … |
"""

from collections.abc import Callable, Mapping
from math import asin, atan2
from typing import Any

import numpy as np

Numbers = dict[str, float]

JOINT_STATES = "sensor_msgs/msg/JointState"

# The kind of a number → its unit. Numbers of a kind and topic have the same noise.
UNITS = {
    "position": "rad or m",
    "velocity": "rad/s or m/s",
    "effort": "N·m or N",
    "place": "m",
    "angle": "rad",
    "linear": "m/s",
    "angular": "rad/s",
    "acceleration": "m/s²",
}
_POSE = {"x": "place", "y": "place", "z": "place", "roll": "angle", "pitch": "angle", "yaw": "angle"}


def kind_of(name: str) -> str:
    """Return the kind of a number, one of `UNITS`."""
    if name in _POSE:
        return _POSE[name]
    first, _, last = name.rpartition(".")
    return last if last in UNITS else first


def continuous(name: str, values: np.ndarray) -> np.ndarray:
    """Return values over time without the jumps that an angle of a pose has at a half turn."""
    return np.unwrap(values) if _POSE.get(name) == "angle" else values


def _joints(message: Any) -> Numbers:
    found = {}
    for kind in ("position", "velocity", "effort"):
        for joint, value in zip(message.name, getattr(message, kind), strict=False):
            found[f"{joint}.{kind}"] = float(value)
    return found


def _vector(name: str, vector: Any) -> Numbers:
    return {f"{name}.{axis}": float(getattr(vector, axis)) for axis in "xyz"}


def _pose(pose: Any) -> Numbers:
    place, q = getattr(pose, "position", None) or pose.translation, getattr(pose, "orientation", None) or pose.rotation
    roll = atan2(2 * (q.w * q.x + q.y * q.z), 1 - 2 * (q.x * q.x + q.y * q.y))
    pitch = asin(min(1.0, max(-1.0, 2 * (q.w * q.y - q.z * q.x))))
    yaw = atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))
    return {"x": float(place.x), "y": float(place.y), "z": float(place.z), "roll": roll, "pitch": pitch, "yaw": yaw}


def _twist(twist: Any) -> Numbers:
    return _vector("linear", twist.linear) | _vector("angular", twist.angular)


NUMBERS: Mapping[str, Callable[[Any], Numbers]] = {
    JOINT_STATES: _joints,
    "nav_msgs/msg/Odometry": lambda message: _pose(message.pose.pose) | _twist(message.twist.twist),
    "geometry_msgs/msg/PoseStamped": lambda message: _pose(message.pose),
    "geometry_msgs/msg/PoseWithCovarianceStamped": lambda message: _pose(message.pose.pose),
    "geometry_msgs/msg/TransformStamped": lambda message: _pose(message.transform),
    "geometry_msgs/msg/TwistStamped": lambda message: _twist(message.twist),
    "geometry_msgs/msg/TwistWithCovarianceStamped": lambda message: _twist(message.twist.twist),
    "sensor_msgs/msg/Imu": lambda message: (
        _vector("angular", message.angular_velocity) | _vector("acceleration", message.linear_acceleration)
    ),
}
