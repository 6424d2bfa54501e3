"""``irobot_create_nodes/motion_control``: what drives a Create 3 robot, by velocities and by goals.

Source: iRobotEducation/create3_sim, motion_control_node.cpp and drive_goal_behaviors.cpp (irobot_create_nodes): names,
limits and tolerances. Docking, wall following and reflexes, which need the infrared sensors and hazards, are not there.
``cmd_vel`` is a Twist, as in Humble, unless a node publishes a TwistStamped on it, as in Jazzy.
"""

from collections.abc import Callable
from math import atan2, copysign, cos, hypot, pi, sin
from typing import Any

import rclpy
from geometry_msgs.msg import PoseStamped, Twist, TwistStamped
from irobot_create_msgs.action import DriveArc, DriveDistance, NavigateToPosition, RotateAngle
from irobot_create_msgs.msg import WheelStatus
from irobot_create_msgs.srv import EStop, RobotPower
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import SetParametersResult
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_sensor_data
from rclpy.task import Future

from drake_twin.kinematics.rotations import heading_of

_SPEEDS = {"none": 0.306, "backup_only": 0.306, "full": 0.46}  # m/s, of a wheel
_TURN = 1.9  # rad/s
_WHEEL_BASE = 0.233  # m
_STOP = 0.5  # s after the last velocity that is heard
_BACKUP = 0.15  # m that it drives backwards at most, in the mode "none"
_SLOW, _CLOSE, _SLOWEST = 0.1, 0.005, 0.05  # m, m, m/s, of a distance
_SLOW_ARC, _SLOW_TURN, _CLOSE_TURN, _SLOWEST_TURN = 0.4, 0.6, pi / 360, 0.1  # rad, rad, rad, rad/s
_CONTROLLER = "diffdrive_controller"

Pose = tuple[float, float, float]  # x, y (m), heading (rad)
Command = tuple[float, float]  # m/s, rad/s


class Distance:
    """Drives straight for a distance (m), at a speed (m/s)."""

    def __init__(self, distance: float, speed: float):
        self.remaining, self._distance = distance, distance
        self._speed = copysign(min(speed, _SPEEDS["none"]), distance)
        self._start: Pose | None = None

    def step(self, pose: Pose) -> Command | None:
        """Return what to do next; None at the end."""
        start = self._start = self._start or pose
        gone = hypot(pose[0] - start[0], pose[1] - start[1])
        self.remaining = copysign(abs(self._distance) - gone, self._distance)
        left = abs(self._distance) - gone
        if left <= _CLOSE:
            return None
        return copysign(
            min(abs(self._speed), max(left, _SLOWEST) if left <= _SLOW else _SPEEDS["full"]), self._speed
        ), 0.0

    def feedback(self, kind: Any) -> Any:
        """Return what remains."""
        return kind.Feedback(remaining_travel_distance=self.remaining)


class Turn:
    """Turns by an angle (rad) at a speed (rad/s); on an arc with a speed along it (m/s) and its radius (m)."""

    def __init__(self, angle: float, speed: float, along: float = 0.0):
        self.remaining, self._sign = angle, copysign(1.0, angle)
        self._speed, self._along = copysign(speed, angle), along
        self._last: float | None = None

    def step(self, pose: Pose) -> Command | None:
        """Return what to do next; None at the end."""
        last = pose[2] if self._last is None else self._last
        self.remaining -= (pose[2] - last + pi) % (2 * pi) - pi
        self._last = pose[2]
        left = self.remaining * self._sign
        if left <= _CLOSE_TURN:
            return None
        if self._along:
            scale = max(left / _SLOW_ARC, 0.2) if left < _SLOW_ARC else 1.0
            return self._along * scale, self._speed * scale
        slow = max(left, _SLOWEST_TURN) if left < _SLOW_TURN else _TURN
        return 0.0, copysign(min(slow, abs(self._speed)), self._speed)

    def feedback(self, kind: Any) -> Any:
        """Return what remains."""
        return kind.Feedback(remaining_angle_travel=self.remaining)


class Way:
    """Turns to a place, drives there, and turns to a heading if that is asked for."""

    def __init__(self, goal: Any):
        place, turn = goal.goal_pose.pose.position, goal.goal_pose.pose.orientation
        self._x, self._y = place.x, place.y
        self._heading = heading_of(turn.w, turn.x, turn.y, turn.z) if goal.achieve_goal_heading else None
        self._speeds = goal.max_translation_speed, min(_TURN, goal.max_rotation_speed)
        self._state, self._part = 0, None  # type: int, Distance | Turn | None

    def step(self, pose: Pose) -> Command | None:
        """Return what to do next; None at the end."""
        while True:
            command = None if self._part is None else self._part.step(pose)
            if command is not None:
                return command
            self._state += 1
            if self._state > 3 or (self._state == 3 and self._heading is None):
                return None
            if self._state == 2:
                self._part = Distance(hypot(self._x - pose[0], self._y - pose[1]), self._speeds[0])
            else:
                to = atan2(self._y - pose[1], self._x - pose[0]) if self._state == 1 else self._heading or 0.0
                self._part = Turn((to - pose[2] + pi) % (2 * pi) - pi, self._speeds[1])

    def feedback(self, kind: Any) -> Any:
        """Return which part of the way it is, and what remains of it."""
        found = kind.Feedback(navigate_state=self._state)
        if isinstance(self._part, Distance):
            found.remaining_travel_distance = self._part.remaining
        elif self._part is not None:
            found.remaining_angle_travel = self._part.remaining
        return found


def _arc(goal: Any) -> Turn:
    speed = min(_SPEEDS["none"], abs(goal.max_translation_speed))
    along = -speed if goal.translate_direction == DriveArc.Goal.TRANSLATE_BACKWARD else speed
    return Turn(goal.angle, speed / abs(goal.radius), along)


class MotionControl(Node):
    """Sends velocities to ``diffdrive_controller`` at 40 Hz."""

    def __init__(self) -> None:
        super().__init__("motion_control")
        self._mode = self.declare_parameter("safety_override", "none").value
        self._may_set = True
        self.declare_parameter("max_speed", _SPEEDS["none"])
        self._may_set = False
        self._pose: Pose = (0.0, 0.0, 0.0)
        self._asked: Command = (0.0, 0.0)
        self._heard = self.get_clock().now()
        self._is_stopped, self._backup, self._told = False, 0.0, 0
        self._behavior: Any = None
        self._end: Future | None = None
        self._output: Any = None
        self.add_on_set_parameters_callback(self._set)
        self._hear_velocities(Twist, "cmd_vel")
        self._hear_velocities(Twist, "cmd_vel_unstamped")
        self.create_subscription(Odometry, "odom", self._hear_odometry, qos_profile_sensor_data)
        self._wheels = self.create_publisher(WheelStatus, "wheel_status", qos_profile_sensor_data)
        self.create_service(EStop, "e_stop", self._stop)
        self.create_service(RobotPower, "robot_power", self._power)
        goals: tuple[tuple[Any, str, Callable[[Any], Any]], ...] = (
            (DriveDistance, "drive_distance", lambda goal: Distance(goal.distance, goal.max_translation_speed)),
            (DriveArc, "drive_arc", _arc),
            (RotateAngle, "rotate_angle", lambda goal: Turn(goal.angle, min(_TURN, goal.max_rotation_speed))),
            (NavigateToPosition, "navigate_to_position", Way),
        )
        group = ReentrantCallbackGroup()
        for kind, name, make in goals:
            ActionServer(
                self,
                kind,
                name,
                lambda goal, kind=kind, make=make: self._execute(goal, kind, make),
                callback_group=group,
                goal_callback=self._may_begin,
                cancel_callback=lambda goal: CancelResponse.ACCEPT,
            )
        self.create_timer(1.0 / 40.0, self._control)

    def _hear_velocities(self, kind: Any, topic: str) -> None:
        self._input = self.create_subscription(kind, topic, self._hear, qos_profile_sensor_data)
        if topic == "cmd_vel":
            self._velocities = self._input

    def _hear(self, message: Any) -> None:
        twist = getattr(message, "twist", message)
        if self._behavior is not None:
            text = "Ignoring velocities commanded while an autonomous behavior is running!"
            self.get_logger().warning(text, throttle_duration_sec=3.0)
            return
        self._asked, self._heard = (twist.linear.x, twist.angular.z), self.get_clock().now()

    def _hear_odometry(self, message: Odometry) -> None:
        place, turn = message.pose.pose.position, message.pose.pose.orientation
        before = self._pose
        self._pose = (place.x, place.y, heading_of(turn.w, turn.x, turn.y, turn.z))
        ahead = hypot(place.x - before[0], place.y - before[1])
        self._backup = min(_BACKUP, self._backup + copysign(ahead, message.twist.twist.linear.x))

    def _set(self, parameters: list[Parameter]) -> SetParametersResult:
        for item in parameters:
            if item.name == "max_speed" and not self._may_set:
                reason = "parameter 'max_speed' cannot be set externally. Only updated from 'safety_override' parameter"
                return SetParametersResult(successful=False, reason=reason)
            if item.name == "safety_override":
                if item.value not in _SPEEDS:
                    self.get_logger().warning(
                        f"Tried to set invalid safety mode {item.value}, options are {list(_SPEEDS)}"
                    )
                    return SetParametersResult(successful=False, reason="Failed to set safety mode, see rosout")
                self._mode = item.value
        return SetParametersResult(successful=True)

    def _stop(self, request: Any, response: Any) -> Any:
        self._is_stopped = request.e_stop_on
        word = ("on, cutting", "off, enabling")[not request.e_stop_on]
        response.success, response.message = True, f"Set system E-Stop {word} motor power"
        return response

    def _power(self, request: Any, response: Any) -> Any:
        response.success, response.message = False, "Set system power off failed (not supported in sim)"
        return response

    # Goals -----------------------------------------------------------------------------------------------------------

    def _may_begin(self, goal: Any) -> GoalResponse:
        if self._behavior is None:
            return GoalResponse.ACCEPT
        self.get_logger().warning("A goal is rejected: a behavior is running already")
        return GoalResponse.REJECT

    async def _execute(self, goal: Any, kind: Any, make: Callable[[Any], Any]) -> Any:
        self._behavior, self._end = make(goal.request), Future()
        self._goal, self._kind = goal, kind
        await self._end
        self._behavior = self._end = None
        if goal.is_cancel_requested:
            goal.canceled()
        else:
            goal.succeed()
        found = PoseStamped()
        found.header.frame_id, found.header.stamp = "odom", self.get_clock().now().to_msg()
        found.pose = self._odometry_pose()
        return kind.Result(pose=found)

    def _odometry_pose(self) -> Any:
        found = PoseStamped().pose
        found.position.x, found.position.y, heading = self._pose
        found.orientation.z, found.orientation.w = sin(heading / 2), cos(heading / 2)
        return found

    # Control ---------------------------------------------------------------------------------------------------------

    def _control(self) -> None:
        self._follow_types()
        if self._mode in _SPEEDS and self.get_parameter("max_speed").value != _SPEEDS[self._mode]:
            self._may_set = True
            self.set_parameters([Parameter("max_speed", value=_SPEEDS[self._mode])])
            self._may_set = False
        command: Command = (0.0, 0.0)
        if self._behavior is not None and self._end is not None:
            following = None if self._goal.is_cancel_requested else self._behavior.step(self._pose)
            if following is None and not self._end.done():
                self._end.set_result(None)
            command = following or command
            self._told += 1
            if following is not None and self._told % 4 == 0:
                self._goal.publish_feedback(self._behavior.feedback(self._kind))
            self._asked = (0.0, 0.0)
        elif (self.get_clock().now() - self._heard).nanoseconds < _STOP * 1e9:
            command = self._asked
        self._send(self._limited(command))

    def _follow_types(self) -> None:
        """Take the type of ``cmd_vel`` and of the controller's topic that the graph has."""
        types = {item.topic_type for item in self.get_publishers_info_by_topic("cmd_vel")}
        wanted = TwistStamped if "geometry_msgs/msg/TwistStamped" in types else Twist
        if types and self._velocities.msg_type is not wanted:
            self.destroy_subscription(self._velocities)
            self._hear_velocities(wanted, "cmd_vel")
        if self._output is None:
            for topic in (f"{_CONTROLLER}/cmd_vel", f"{_CONTROLLER}/cmd_vel_unstamped"):
                for item in self.get_subscriptions_info_by_topic(topic):
                    kind = TwistStamped if item.topic_type.endswith("TwistStamped") else Twist
                    self._output = self._output or self.create_publisher(kind, topic, 10)

    def _limited(self, command: Command) -> Command:
        linear, angular = command
        angular = copysign(min(abs(angular), _TURN), angular)
        if self._mode == "none" and self._backup <= 0.0 and linear < 0.0:
            text = "Reached backup limit! Stop Driving robot backward or disable from safety_override parameter!"
            self.get_logger().warning(text, throttle_duration_sec=3.0)
            return 0.0, 0.0
        fastest = max(abs(linear - 0.5 * _WHEEL_BASE * angular), abs(linear + 0.5 * _WHEEL_BASE * angular))
        scale = min(1.0, _SPEEDS.get(self._mode, _SPEEDS["none"]) / fastest) if fastest else 1.0
        return linear * scale, angular * scale

    def _send(self, command: Command) -> None:
        now = self.get_clock().now().to_msg()
        if self._output is not None:
            message = self._output.msg_type()
            twist = message
            if self._output.msg_type is TwistStamped:
                message.header.stamp, twist = now, message.twist
            if not self._is_stopped:
                twist.linear.x, twist.angular.z = map(float, command)
            self._output.publish(message)
        status = WheelStatus(wheels_enabled=not self._is_stopped)
        status.header.stamp, status.header.frame_id = now, "base_link"
        self._wheels.publish(status)


def main() -> None:
    """Run the node."""
    rclpy.init()
    rclpy.spin(MotionControl())
