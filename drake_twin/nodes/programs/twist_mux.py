"""``twist_mux/twist_mux``: pass on the topic of twists that has the highest priority, as its version 4.4 does.

Source: ros-teleop/twist_mux, src/twist_mux.cpp and include/twist_mux/topic_handle.hpp. Diagnostics are not published.
"""

from typing import Any

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from rclpy.node import Node
from std_msgs.msg import Bool


class Handle:
    """A topic of twists, or of locks.

    Args:
        node: The node.
        name: The name of its parameters: ``topics.NAME`` or ``locks.NAME``.
        kind: Its type.
        heard: Is called after each message.
    """

    def __init__(self, node: Node, name: str, kind: type, heard: Any = None):
        own = node.get_parameters_by_prefix(name)
        missing = [item for item in ("topic", "timeout", "priority") if item not in own]
        if missing:
            raise SystemExit(f"Parameter '{name}.{missing[0]}' not found")
        self.name, self._node, self._heard = name, node, heard
        self._timeout = float(own["timeout"].value)
        self.priority = min(max(int(own["priority"].value), 0), 255)
        self._stamp, self._message = 0, kind()
        self._subscription = node.create_subscription(kind, own["topic"].value, self._hear, 10)

    @property
    def has_expired(self) -> bool:
        """Whether its last message is too old; at the start the stamp is zero."""
        age = self._node.get_clock().now().nanoseconds - self._stamp
        return self._timeout > 0.0 and age * 1e-9 > self._timeout

    @property
    def is_locked(self) -> bool:
        """Whether a lock is locked, or has been silent for too long."""
        return self.has_expired or bool(self._message.data)

    def _hear(self, message: Any) -> None:
        self._stamp, self._message = self._node.get_clock().now().nanoseconds, message
        if self._heard is not None:
            self._heard(self, message)


class TwistMux(Node):
    """The multiplexer."""

    def __init__(self) -> None:
        super().__init__(
            "twist_mux", allow_undeclared_parameters=True, automatically_declare_parameters_from_overrides=True
        )
        kind = TwistStamped if self._is_stamped() else Twist
        self._publisher = self.create_publisher(kind, "cmd_vel_out", 1)
        self._locks = [Handle(self, name, Bool) for name in self._names("locks")]
        self._topics: list[Handle] = []
        self._topics += [Handle(self, name, kind, self._pass_on) for name in self._names("topics")]

    def _names(self, prefix: str) -> list[str]:
        names = {name.partition(".")[0] for name in self.get_parameters_by_prefix(prefix)}
        return [f"{prefix}.{name}" for name in sorted(names)]

    def _is_stamped(self) -> bool:
        """Return ``use_stamped``; without it what takes the output decides, and Jazzy's default is true."""
        given = self.get_parameter_or("use_stamped").value
        if given is not None:
            return bool(given)
        types = dict(self.get_topic_names_and_types()).get(self.resolve_topic_name("cmd_vel_out"), [])
        return bool(types != ["geometry_msgs/msg/Twist"])

    def _pass_on(self, topic: Handle, message: Any) -> None:
        lock = max((item.priority for item in self._locks if item.is_locked), default=0)
        open_topics = [item for item in self._topics if not item.has_expired and item.priority >= lock]
        highest = max((item.priority for item in open_topics), default=0)
        if highest > 0 and topic is next(item for item in open_topics if item.priority == highest):
            self._publisher.publish(message)


def main() -> None:
    """Run the node."""
    rclpy.init()
    rclpy.spin(TwistMux())
