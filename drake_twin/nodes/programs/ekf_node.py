"""``robot_localization/ekf_node``: odometry, poses, twists and IMUs fused to one estimate and its transform.

Source: cra-ros-pkg/robot_localization (ros2), src/ros_filter.cpp. Diagnostics, control inputs, ``smooth_lagged_data``
and ``…_pose_use_child_frame`` are not there.
"""

import heapq
from collections.abc import Callable
from itertools import count
from math import inf
from typing import Any

import numpy as np
import rclpy
from geometry_msgs.msg import (
    AccelWithCovarianceStamped,
    PoseWithCovarianceStamped,
    TransformStamped,
    TwistWithCovarianceStamped,
)
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.time import Time
from robot_localization.srv import SetPose, ToggleFilterProcessing
from sensor_msgs.msg import Imu
from std_srvs.srv import Empty
from tf2_ros import Buffer, TransformBroadcaster, TransformException, TransformListener
from tf_transformations import quaternion_from_matrix, quaternion_matrix

from drake_twin.nodes.kalman_filter import (
    ACCELERATION,
    ORIENTATION,
    POSE,
    POSITION,
    SIZE,
    TURN,
    TWIST,
    VELOCITY,
    KalmanFilter,
    Measurement,
    angles,
    rotation,
)
from drake_twin.nodes.measured_motion import Motion, Source, put_acceleration, put_pose, put_twist
from drake_twin.nodes.task import present_task

_NOT_THERE = ("use_control", "smooth_lagged_data")
_POSES, _TWISTS = (POSITION, ORIENTATION), (VELOCITY, TURN)
# Kind of topic → the parts of the state that its messages have, each with its parameter of the Mahalanobis distance.
_PARTS = {
    "odom": ((_POSES, "_pose_rejection_threshold"), (_TWISTS, "_twist_rejection_threshold")),
    "pose": ((_POSES, "_rejection_threshold"),),
    "twist": ((_TWISTS, "_rejection_threshold"),),
    "imu": (
        ((ORIENTATION,), "_pose_rejection_threshold"),
        ((TURN,), "_twist_rejection_threshold"),
        ((ACCELERATION,), "_linear_acceleration_rejection_threshold"),
    ),
}


class EkfNode(Node):
    """The filter with its topics."""

    def __init__(self) -> None:
        super().__init__("ekf_filter_node")
        value = self.value
        self._filter = KalmanFilter()
        self._map, self._odom = value("map_frame", "map"), value("odom_frame", "odom")
        self._base = value("base_link_frame", "base_link")
        self._output = value("base_link_frame_output", self._base)
        self._world = value("world_frame", self._odom)
        if self._map == self._odom or self._odom == self._base or self._map == self._base:
            raise SystemExit("map_frame, odom_frame and base_link_frame must differ")
        if self._world not in (self._map, self._odom):
            raise SystemExit(f"world_frame is {self._world!r}, but must be map_frame or odom_frame")
        frequency = float(value("frequency", 30.0))
        self._timeout = float(value("sensor_timeout", 1.0 / frequency)) * 1e9
        self._is_planar = value("two_d_mode", False)
        self._is_enabled = not value("disabled_at_startup", False)
        self._is_on = True
        self._predicts = value("predict_to_current_time", False)
        self._repeats = value("permit_corrected_publication", False)
        self._offset = round(float(value("transform_time_offset", 0.0)) * 1e9)
        self._gravity = float(value("gravitational_acceleration", 9.80665))
        for name in _NOT_THERE:
            if value(name, False):
                present_task().program.ignored(f"the parameter {name} is not followed")
        self._set_up_filter()
        self._angular_acceleration, self._turn, self._turn_time = np.zeros(3), np.zeros(3), 0
        self._queue: list[tuple[int, int, Measurement]] = []
        self._numbers = count()
        self._published = self._posed = -1
        self._buffer = Buffer()
        self._listener = TransformListener(self._buffer, self)
        self._broadcaster: Any = TransformBroadcaster(self) if value("publish_tf", True) else None
        self._publisher = self.create_publisher(Odometry, "odometry/filtered", 10)
        self._accelerations: Any = None
        if value("publish_acceleration", False):
            self._accelerations = self.create_publisher(AccelWithCovarianceStamped, "accel/filtered", 10)
        self._sources: list[Source] = []
        self._subscribe()
        self.create_subscription(PoseWithCovarianceStamped, "set_pose", self._set_pose, 1)
        self.create_service(SetPose, "set_pose", self._serve_pose)
        self.create_service(Empty, "enable", self._enable)
        self.create_service(Empty, "reset", self._reset)
        self.create_service(ToggleFilterProcessing, "toggle", self._toggle)
        self.create_timer(1.0 / frequency, self._update)

    def value(self, name: str, default: Any = None) -> Any:
        """Declare a parameter, and return its value."""
        return self.declare_parameter(name, default).value

    def _set_up_filter(self) -> None:
        self._filter.is_dynamic = self.value("dynamic_process_noise_covariance", False)
        for parameter, name in (
            ("process_noise_covariance", "process_noise"),
            ("initial_estimate_covariance", "covariance"),
        ):
            numbers = self.value(parameter, [0.0])
            if len(numbers) == SIZE:
                setattr(self._filter, name, np.diag(np.array(numbers, dtype=float)))
            elif len(numbers) == SIZE * SIZE:
                setattr(self._filter, name, np.array(numbers, dtype=float).reshape(SIZE, SIZE))
            elif len(numbers) > 1:
                both = f"{SIZE} or {SIZE * SIZE}"
                raise SystemExit(f"the parameter {parameter} has {len(numbers)} elements, but {both} are needed")
        state = self.value("initial_state", [0.0])
        if len(state) == SIZE:
            self._filter.state = np.array(state, dtype=float)

    def _subscribe(self) -> None:
        self._without_gravity: set[str] = set()
        kinds: dict[str, tuple[type, Callable[..., None]]] = {
            "odom": (Odometry, self._hear_odometry),
            "pose": (PoseWithCovarianceStamped, self._hear_pose),
            "twist": (TwistWithCovarianceStamped, self._hear_twist),
            "imu": (Imu, self._hear_imu),
        }
        for kind, (message_type, hear) in kinds.items():
            for index in count():
                name = f"{kind}{index}"
                topic = self.value(name, "")
                if not topic:
                    break
                sources = self._sources_of(kind, name)
                self._sources += sources
                profile = QoSProfile(depth=max(1, int(self.value(f"{name}_queue_size", 10))))
                self.create_subscription(message_type, topic, _with(hear, sources), profile)

    def _sources_of(self, kind: str, name: str) -> list[Source]:
        config = self.value(f"{name}_config", [False] * SIZE)
        if len(config) != SIZE:
            raise SystemExit(f"the parameter {name}_config has {len(config)} elements, but {SIZE} are needed")
        if kind == "imu" and self.value(f"{name}_remove_gravitational_acceleration", False):
            self._without_gravity.add(name)
        differential, relative = self.value(f"{name}_differential", False), self.value(f"{name}_relative", False)
        return [
            Source(
                name,
                config,
                part,
                float(self.value(name + threshold, inf)),
                is_differential=differential,
                is_relative=relative and not differential,
            )
            for part, threshold in _PARTS[kind]
        ]

    # Messages --------------------------------------------------------------------------------------------------------

    def _hear_odometry(self, message: Any, pose: Source, twist: Source) -> None:
        self._pose(pose, message.header, message.pose)
        self._twist(twist, message.header, message.child_frame_id, message.twist)

    def _hear_pose(self, message: Any, pose: Source) -> None:
        self._pose(pose, message.header, message.pose)

    def _hear_twist(self, message: Any, twist: Source) -> None:
        self._twist(twist, message.header, message.header.frame_id, message.twist)

    def _hear_imu(self, message: Any, pose: Source, twist: Source, acceleration: Source) -> None:
        """Take what an IMU has; where it has nothing, its covariance begins with -1."""
        if message.orientation_covariance[0] != -1:
            own = PoseWithCovarianceStamped(header=message.header).pose
            own.pose.orientation = message.orientation
            own.covariance = _in_block(message.orientation_covariance)
            self._pose(pose, message.header, own, is_imu=True)
        if message.angular_velocity_covariance[0] != -1:
            turn = TwistWithCovarianceStamped(header=message.header).twist
            turn.twist.angular = message.angular_velocity
            turn.covariance = _in_block(message.angular_velocity_covariance)
            self._twist(twist, message.header, message.header.frame_id, turn)
        if message.linear_acceleration_covariance[0] != -1:
            self._acceleration(acceleration, message)

    def _begin(self, source: Source, header: Any) -> Measurement | None:
        time = Time.from_msg(header.stamp).nanoseconds
        return None if time <= self._posed else source.begin(time)

    def _put(self, measurement: Measurement) -> None:
        if self._is_planar:
            measurement.flatten()
        heapq.heappush(self._queue, (measurement.time, next(self._numbers), measurement))

    def _motion(self, target: str, source: str, time: int) -> Motion | None:
        """Return the transform between two frames at a time, or else the last one; None without one."""
        if target == source:
            return np.eye(3), np.zeros(3)
        for when in (Time(nanoseconds=time), Time()):
            try:
                found = self._buffer.lookup_transform(target, source, when).transform
            except TransformException as error:
                text = f"Could not obtain transform from {source} to {target}. Error was {error}"
                continue
            return _matrix(found.rotation), _vector(found.translation)
        self.get_logger().warning(text, throttle_duration_sec=2.0)
        return None

    def _pose(self, source: Source, header: Any, pose: Any, *, is_imu: bool = False) -> None:
        measurement = self._begin(source, header)
        if measurement is None:
            return
        target = self._base if is_imu else self._world
        frame = target if source.is_differential and not is_imu else header.frame_id or self._world
        motion = self._motion(target, frame, measurement.time)
        if motion is None:
            return
        own = _matrix(pose.pose.orientation), _vector(pose.pose.position)
        if put_pose(measurement, source, motion, own, np.array(pose.covariance).reshape(6, 6), is_imu=is_imu):
            self._put(measurement)

    def _twist(self, source: Source, header: Any, frame: str, twist: Any) -> None:
        measurement = self._begin(source, header)
        motion = None if measurement is None else self._motion(self._base, frame or self._base, measurement.time)
        if measurement is None or motion is None:
            return
        own = np.concatenate((_vector(twist.twist.linear), _vector(twist.twist.angular)))
        covariance = np.array(twist.covariance).reshape(6, 6)
        put_twist(measurement, source, motion, own, covariance, self._filter.state[TURN])
        self._put(measurement)

    def _acceleration(self, source: Source, message: Any) -> None:
        measurement = self._begin(source, message.header)
        frame = message.header.frame_id or self._base
        motion = None if measurement is None else self._motion(self._base, frame, measurement.time)
        if measurement is None or motion is None:
            return
        covariance = np.array(message.linear_acceleration_covariance).reshape(3, 3)
        turn = self._filter.state[TURN], self._angular_acceleration
        put_acceleration(measurement, source, motion, _vector(message.linear_acceleration), covariance, turn)
        if source.name in self._without_gravity:
            attitude = _matrix(message.orientation)
            if message.orientation_covariance[0] == -1:
                attitude = rotation(*self._filter.state[ORIENTATION]) @ motion[0]
            elif source.is_relative:
                attitude = attitude @ motion[0]
            measurement.values[ACCELERATION] -= attitude.T @ np.array((0.0, 0.0, self._gravity))
        self._put(measurement)

    # The estimate ----------------------------------------------------------------------------------------------------

    def _update(self) -> None:
        now, own = self.get_clock().now().nanoseconds, self._filter
        if not self._is_enabled:
            return
        if self._is_on:
            is_late = not self._queue and own.has_begun and now - own.time >= self._timeout
            while self._queue and self._queue[0][0] <= now:
                own.process(heapq.heappop(self._queue)[2])
            if own.has_begun and (self._predicts or is_late) and now > own.time:
                own.predict(now)
            if own.has_begun and now > self._turn_time:
                turn = own.state[TURN].copy()
                self._angular_acceleration = (turn - self._turn) / ((now - self._turn_time) * 1e-9)
                self._turn, self._turn_time = turn, now
        else:
            self._queue.clear()
            own.time = now
        if own.has_begun and (self._repeats or own.time > self._published):
            self._published = own.time
            self._publish()

    def _publish(self) -> None:
        own, message = self._filter, Odometry()
        R, p = rotation(*own.state[ORIENTATION]), own.state[POSITION]
        message.header.stamp, message.header.frame_id = Time(nanoseconds=own.time).to_msg(), self._world
        message.child_frame_id = self._output
        _set_vector(message.pose.pose.position, p)
        _set_rotation(message.pose.pose.orientation, R)
        _set_vector(message.twist.twist.linear, own.state[VELOCITY])
        _set_vector(message.twist.twist.angular, own.state[TURN])
        message.pose.covariance = own.covariance[POSE, POSE].ravel()
        message.twist.covariance = own.covariance[TWIST, TWIST].ravel()
        if self._broadcaster is not None:
            self._broadcast(R, p)
        self._publisher.publish(message)
        if self._accelerations is not None:
            acceleration = AccelWithCovarianceStamped(header=message.header)
            acceleration.header.frame_id = self._output
            _set_vector(acceleration.accel.accel.linear, own.state[ACCELERATION])
            _set_vector(acceleration.accel.accel.angular, self._angular_acceleration)
            covariance = np.zeros((6, 6))
            covariance[:3, :3] = own.covariance[ACCELERATION, ACCELERATION]
            acceleration.accel.covariance = covariance.ravel()
            self._accelerations.publish(acceleration)

    def _broadcast(self, R: np.ndarray, p: np.ndarray) -> None:
        """Publish odom → base; in a filter of the map map → odom, below which another one places the base."""
        child = self._output
        if self._world == self._map:
            motion = self._motion(self._base, self._odom, 0)
            if motion is None:
                return
            R, p, child = R @ motion[0], R @ motion[1] + p, self._odom
        transform = TransformStamped(child_frame_id=child)
        transform.header.frame_id = self._world
        transform.header.stamp = Time(nanoseconds=self._filter.time + self._offset).to_msg()
        _set_vector(transform.transform.translation, p)
        _set_rotation(transform.transform.rotation, R)
        self._broadcaster.sendTransform(transform)

    # Services --------------------------------------------------------------------------------------------------------

    def _forget(self) -> None:
        self._queue.clear()
        for source in self._sources:
            source.forget()

    def _set_pose(self, message: Any) -> None:
        self._forget()
        motion = self._motion(self._world, message.header.frame_id or self._world, 0)
        if motion is None:
            return
        R, offset = motion
        own = self._filter
        own.state, own.covariance = np.zeros(SIZE), 1e-6 * np.eye(SIZE)
        own.state[POSITION] = R @ _vector(message.pose.pose.position) + offset
        own.state[ORIENTATION] = angles(R @ _matrix(message.pose.pose.orientation))
        both = np.kron(np.eye(2), R)
        own.covariance[POSE, POSE] = both @ np.array(message.pose.covariance).reshape(6, 6) @ both.T
        own.time, own.has_begun = self.get_clock().now().nanoseconds, True
        self._posed = Time.from_msg(message.header.stamp).nanoseconds

    def _serve_pose(self, request: Any, response: Any) -> Any:
        self._set_pose(request.pose)
        return response

    def _enable(self, request: Any, response: Any) -> Any:
        self._is_enabled = True
        return response

    def _reset(self, request: Any, response: Any) -> Any:
        self._forget()
        self._filter, noise = KalmanFilter(), self._filter.process_noise
        self._filter.process_noise = noise
        self._published = self._posed = -1
        return response

    def _toggle(self, request: Any, response: Any) -> Any:
        response.status = request.on != self._is_on
        self._is_on = request.on
        return response


def _in_block(covariance: Any) -> np.ndarray:
    """Return the covariance of three angles, or of their rates, as that of a pose, or of a twist."""
    whole = np.zeros((6, 6))
    whole[3:, 3:] = np.array(covariance).reshape(3, 3)
    return whole.ravel()


def _matrix(rotation_message: Any) -> np.ndarray:
    numbers = (rotation_message.x, rotation_message.y, rotation_message.z, rotation_message.w)
    return np.array(quaternion_matrix(numbers))[:3, :3] if any(numbers) else np.eye(3)


def _vector(message: Any) -> np.ndarray:
    return np.array((message.x, message.y, message.z))


def _with(hear: Callable[..., None], sources: list[Source]) -> Callable[[Any], None]:
    return lambda message: hear(message, *sources)


def _set_vector(message: Any, values: np.ndarray) -> None:
    message.x, message.y, message.z = map(float, values)


def _set_rotation(message: Any, R: np.ndarray) -> None:
    whole = np.eye(4)
    whole[:3, :3] = R
    message.x, message.y, message.z, message.w = map(float, quaternion_from_matrix(whole))


def main() -> None:
    """Run the node."""
    rclpy.init()
    rclpy.spin(EkfNode())
