"""``turtlesim``: the turtles of ROS's tutorials, in steps of 16 ms as upstream's, without their window.

Source: ros/ros_tutorials, turtlesim/src/turtle_frame.cpp, turtle.cpp and tutorials/mimic.cpp. Lengths are in m of 45
pixels each; the field is 500 pixels wide and high. A line covers the pixels whose centre is in it; Qt's may
differ by one.
"""

from math import cos, floor, hypot, pi, sin
from typing import Any

import numpy as np
import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor
from rclpy.action import ActionServer, CancelResponse
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import Empty
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Color, Pose
from turtlesim.srv import Kill, SetPen, Spawn, TeleportAbsolute, TeleportRelative

_PERIOD = 0.016  # s
_PIXELS, _METER = 500, 45.0
_SIZE = float(np.float32(_PIXELS - 1) / np.float32(_METER))
_BACKGROUND = {"background_r": 0x45, "background_g": 0x56, "background_b": 0xFF}
_PEN, _PEN_WIDTH = (0xB3, 0xB8, 0xFF), 3
_LONGEST = Duration(seconds=1)  # a command lasts no longer
_CLOSE = 0.02  # rad: a rotation has reached its goal
_NOTHING = 255  # each channel where nothing is drawn


def _normalized(angle: float) -> float:
    return angle - 2 * pi * floor((angle + pi) / (2 * pi))


class Turtle:
    """A turtle; as on a screen, its y points down.

    Args:
        node: The node.
        name: Its name.
        x, y: Its position (m).
        angle: Its heading (rad).
    """

    def __init__(self, node: Node, name: str, x: float, y: float, angle: float):
        self.x, self.y, self.angle = x, y, angle
        self._node = node
        self._forward = self._left = self._turn = 0.0
        self._pen: tuple[int, int, int] | None = _PEN
        self._width = _PEN_WIDTH
        self._teleports: list[Any] = []
        self._goal: Any = None
        self._heard = node.get_clock().now()
        self._pose = node.create_publisher(Pose, f"{name}/pose", 10)
        self._color = node.create_publisher(Color, f"{name}/color_sensor", 10)
        self._subscription = node.create_subscription(Twist, f"{name}/cmd_vel", self._hear, 10)
        self._services = [
            node.create_service(SetPen, f"{name}/set_pen", self._set_pen),
            node.create_service(TeleportRelative, f"{name}/teleport_relative", self._teleport),
            node.create_service(TeleportAbsolute, f"{name}/teleport_absolute", self._teleport),
        ]
        self._action = ActionServer(
            node,
            RotateAbsolute,
            f"{name}/rotate_absolute",
            execute_callback=self._rotate,
            cancel_callback=lambda handle: CancelResponse.ACCEPT,
        )

    def destroy(self) -> None:
        """Take it off the graph."""
        self._action.destroy()
        self._node.destroy_subscription(self._subscription)
        for service in self._services:
            self._node.destroy_service(service)
        for publisher in (self._pose, self._color):
            self._node.destroy_publisher(publisher)

    def update(self, image: Any) -> None:
        """Move it for a period, and publish where it is.

        Args:
            image: The drawing, row by row (500 x 500 x 3).
        """
        for request in self._teleports:
            start = self.x, self.y
            if hasattr(request, "linear"):
                self.angle += request.angular
                self.x += cos(self.angle) * request.linear
                self.y -= sin(self.angle) * request.linear
            else:
                self.x, self.y, self.angle = request.x, max(0.0, _SIZE - request.y), request.theta
            self._draw(image, start)
        self._teleports.clear()
        if self._goal is not None:
            self._follow_goal()
        if self._node.get_clock().now() - self._heard > _LONGEST:
            self._stop()
        start = self.x, self.y
        self.angle = _normalized(self.angle + self._turn * _PERIOD)
        self.x += (cos(self.angle) * self._forward - sin(self.angle) * self._left) * _PERIOD
        self.y -= (cos(self.angle) * self._left + sin(self.angle) * self._forward) * _PERIOD
        if not (0 <= self.x <= _SIZE and 0 <= self.y <= _SIZE):
            where = f"[x={self.x:f}, y={self.y:f}]"
            self._node.get_logger().warning(f"Oh no! I hit the wall! (Clamping from {where})")
        self.x, self.y = min(max(self.x, 0.0), _SIZE), min(max(self.y, 0.0), _SIZE)
        speed = hypot(self._forward, self._left)
        pose = Pose(x=self.x, y=_SIZE - self.y, theta=self.angle, linear_velocity=speed, angular_velocity=self._turn)
        self._pose.publish(pose)
        red, green, blue = image[round(self.y * _METER), round(self.x * _METER)].tolist()
        self._color.publish(Color(r=red, g=green, b=blue))
        if (self.x, self.y) != start:
            self._draw(image, start)

    def _draw(self, image: Any, start: tuple[float, float]) -> None:
        """Draw a line from a position (m) to the present one."""
        if self._pen is None:
            return
        first, last = np.array(start) * _METER, np.array((self.x, self.y)) * _METER
        reach = max(self._width / 2, 0.5)
        low = np.maximum(np.floor(np.minimum(first, last) - reach), 0).astype(int)
        high = np.minimum(np.ceil(np.maximum(first, last) + reach) + 1, _PIXELS).astype(int)
        columns, rows = np.ogrid[low[0] : high[0], low[1] : high[1]]
        along = last - first
        part = (columns - first[0]) * along[0] + (rows - first[1]) * along[1]
        part = np.clip(part / max(along @ along, 1e-12), 0.0, 1.0)
        far = np.hypot(first[0] + part * along[0] - columns, first[1] + part * along[1] - rows)
        image[low[1] : high[1], low[0] : high[0]][(far <= reach).T] = self._pen

    def _stop(self) -> None:
        self._forward = self._left = self._turn = 0.0

    def _hear(self, message: Twist) -> None:
        self._heard = self._node.get_clock().now()
        self._forward, self._turn = message.linear.x, message.angular.z
        if self._node.get_parameter("holonomic").value:
            self._left = message.linear.y
        if self._goal is not None:
            self._node.get_logger().warning("Velocity command received during rotation goal. Aborting goal")
            self._end_goal("abort")

    def _set_pen(self, request: Any, response: Any) -> Any:
        self._pen = None if request.off else (request.r, request.g, request.b)
        if not request.off:
            self._width = request.width or 1
        return response

    def _teleport(self, request: Any, response: Any) -> Any:
        self._teleports.append(request)
        return response

    async def _rotate(self, handle: Any) -> Any:
        """Wait until a goal has ended, which `update` follows."""
        if self._goal is not None:
            text = "Rotation goal received before a previous goal finished. Aborting previous goal"
            self._node.get_logger().warning(text)
            self._end_goal("abort")
        self._goal, self._start = handle, self.angle
        self._result, self._ended = RotateAbsolute.Result(), Future()
        return await self._ended

    def _follow_goal(self) -> None:
        if self._goal.is_cancel_requested:
            self._node.get_logger().info("Rotation goal canceled")
            self._end_goal("canceled")
            self._stop()
            return
        remaining = _normalized(_normalized(self._goal.request.theta) - self.angle)
        self._result.delta = _normalized(self._start - self.angle)
        self._goal.publish_feedback(RotateAbsolute.Feedback(remaining=remaining))
        self._stop()
        if abs(remaining) < _CLOSE:
            self._node.get_logger().info("Rotation goal completed successfully")
            self._end_goal("succeed")
        else:
            self._turn = -1.0 if remaining < 0 else 1.0
            self._heard = self._node.get_clock().now()

    def _end_goal(self, how: str) -> None:
        getattr(self._goal, how)()
        self._goal = None
        self._ended.set_result(self._result)


class TurtleSim(Node):
    """The field with its turtles."""

    def __init__(self) -> None:
        super().__init__("turtlesim")
        channel = [IntegerRange(from_value=0, to_value=255, step=1)]
        for name, value in _BACKGROUND.items():
            self.declare_parameter(name, value, ParameterDescriptor(integer_range=channel))
        self.declare_parameter("holonomic", False)
        self._image = np.full((_PIXELS, _PIXELS, 3), _NOTHING, np.uint8)
        self._turtles: dict[str, Turtle] = {}
        self._count = 0
        self._has_begun = False
        self.create_service(Empty, "clear", self._clear)
        self.create_service(Empty, "reset", self._reset)
        self.create_service(Spawn, "spawn", self._spawn)
        self.create_service(Kill, "kill", self._kill)
        self.get_logger().info(f"Starting turtlesim with node name {self.get_fully_qualified_name()}")
        self._add("", _SIZE / 2, _SIZE / 2, 0.0)
        self.create_timer(_PERIOD, self._update)

    def _add(self, name: str, x: float, y: float, angle: float) -> str:
        """Add a turtle; return its name, which is empty if there is one of that name."""
        if name in self._turtles:
            return ""
        while not name or name in self._turtles:
            self._count += 1
            name = f"turtle{self._count}"
        self._turtles[name] = Turtle(self, name, x, _SIZE - y, angle)
        self.get_logger().info(f"Spawning turtle [{name}] at x=[{x:f}], y=[{y:f}], theta=[{angle:f}]")
        return name

    def _update(self) -> None:
        if self._has_begun:
            for _, turtle in sorted(self._turtles.items()):
                turtle.update(self._image)
        self._has_begun = True

    def _spawn(self, request: Any, response: Any) -> Any:
        response.name = self._add(request.name, request.x, request.y, request.theta)
        if not response.name:
            self.get_logger().error(f"A turtle named [{request.name}] already exists")
        return response

    def _kill(self, request: Any, response: Any) -> Any:
        turtle = self._turtles.pop(request.name, None)
        if turtle is None:
            self.get_logger().error(f"Tried to kill turtle [{request.name}], which does not exist")
        else:
            turtle.destroy()
        return response

    def _clear(self, request: Any, response: Any) -> Any:
        self.get_logger().info("Clearing turtlesim.")
        self._image[:] = _NOTHING
        return response

    def _reset(self, request: Any, response: Any) -> Any:
        self.get_logger().info("Resetting turtlesim.")
        while self._turtles:
            self._turtles.popitem()[1].destroy()
        self._count = 0
        self._add("", _SIZE / 2, _SIZE / 2, 0.0)
        self._image[:] = _NOTHING
        return response


def main() -> None:
    """Run the node."""
    rclpy.init()
    rclpy.spin(TurtleSim())


def mimic() -> None:
    """Run the node that lets a turtle move as another one does."""
    rclpy.init()
    node = rclpy.create_node("turtle_mimic")
    publisher = node.create_publisher(Twist, "output/cmd_vel", 1)

    def hear(pose: Pose) -> None:
        twist = Twist()
        twist.linear.x, twist.angular.z = pose.linear_velocity, pose.angular_velocity
        publisher.publish(twist)

    node.create_subscription(Pose, "input/pose", hear, 1)
    rclpy.spin(node)
