"""``teleop_twist_joy/teleop_node``: velocities from the axes of a joystick's messages, while a button is held.

Source: ros2/teleop_twist_joy (2.6), src/teleop_twist_joy.cpp. Parameters are read at the start.
"""

from typing import Any

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from rclpy.node import Node
from sensor_msgs.msg import Joy

# Name of an axis → the field that it commands, the default of its number, and of its scale without and with the turbo.
_LINEAR = {"x": ("x", 5, 0.5, 1.0), "y": ("y", -1, 0.0, 0.0), "z": ("z", -1, 0.0, 0.0)}
_ANGULAR = {"yaw": ("z", 2, 0.5, 1.0), "pitch": ("y", -1, 0.0, 0.0), "roll": ("x", -1, 0.0, 0.0)}


class TeleopTwistJoy(Node):
    """Publishes ``cmd_vel``."""

    def __init__(self) -> None:
        super().__init__("teleop_twist_joy_node")
        self._is_stamped = self._value("publish_stamped_twist", False)
        self._frame = self._value("frame", "teleop_twist_joy")
        self._publisher = self.create_publisher(TwistStamped if self._is_stamped else Twist, "cmd_vel", 10)
        self._needs_button = self._value("require_enable_button", True)
        self._button, self._turbo = self._value("enable_button", 5), self._value("enable_turbo_button", -1)
        self._turns_round = self._value("inverted_reverse", False)
        # (part of the twist, field) → the axis and its two scales
        self._axes: dict[tuple[str, str], tuple[int, float, float]] = {}
        for part, names in (("linear", _LINEAR), ("angular", _ANGULAR)):
            for name, (field, axis, scale, turbo) in names.items():
                self._axes[part, field] = (
                    self._value(f"axis_{part}.{name}", axis),
                    self._value(f"scale_{part}.{name}", scale),
                    self._value(f"scale_{part}_turbo.{name}", turbo),
                )
        self._has_stopped = False
        self.create_subscription(Joy, "joy", self._hear, 10)

    def _value(self, name: str, default: Any) -> Any:
        return self.declare_parameter(name, default).value

    def _hear(self, joy: Joy) -> None:
        if self._turbo >= 0 and _is_held(joy, self._turbo):
            self._send(joy, is_turbo=True)
        elif not self._needs_button or _is_held(joy, self._button):
            self._send(joy, is_turbo=False)
        elif not self._has_stopped:
            self._has_stopped = True
            self._publish(Twist())

    def _send(self, joy: Joy, *, is_turbo: bool) -> None:
        twist = Twist()
        for (part, field), (axis, scale, turbo) in self._axes.items():
            if 0 <= axis < len(joy.axes):
                setattr(getattr(twist, part), field, joy.axes[axis] * (turbo if is_turbo else scale))
        if self._turns_round and twist.linear.x < 0:
            twist.angular.z = -twist.angular.z
        self._has_stopped = False
        self._publish(twist)

    def _publish(self, twist: Twist) -> None:
        message = twist
        if self._is_stamped:
            message = TwistStamped(twist=twist)
            message.header.stamp, message.header.frame_id = self.get_clock().now().to_msg(), self._frame
        self._publisher.publish(message)


def _is_held(joy: Joy, button: int) -> bool:
    return bool(button < len(joy.buttons) and joy.buttons[button])


def main() -> None:
    """Run the node."""
    rclpy.init()
    rclpy.spin(TeleopTwistJoy())
