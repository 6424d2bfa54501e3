"""``topic_tools/relay`` and ``topic_tools/throttle``: pass on what is published on a topic to another one.

Source: ros-tooling/topic_tools (jazzy), src/tool_base_node.cpp, src/relay_node.cpp and src/throttle_node.cpp. They look
for the input every 0.1 s. ``lazy`` and the throttle by bytes are not there.
"""

import sys
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.utilities import remove_ros_args
from rosidl_runtime_py.utilities import get_message

_DISCOVERY = 0.1  # s


class Relay(Node):
    """Passes messages on."""

    def __init__(self, name: str = "relay"):
        super().__init__(name)
        words = [word for word in remove_ros_args(sys.argv)[1:] if not word.startswith("-")]
        own = dict(zip(("input_topic", "output_topic"), words, strict=False))
        self._input = self.declare_parameter("input_topic", own.get("input_topic", "")).value
        if not self._input:
            raise SystemExit("the parameter input_topic is not set")
        default = own.get("output_topic", f"{self._input}_{name}")
        self._output = self.declare_parameter("output_topic", default).value
        self.declare_parameter("lazy", False)
        self._publisher: Any = None
        self._timer = self.create_timer(_DISCOVERY, self._discover)
        self._discover()

    def _discover(self) -> None:
        types = dict(self.get_topic_names_and_types()).get(self.resolve_topic_name(self._input))
        if not types or self._publisher is not None or not self.count_publishers(self._input):
            return
        kind, profile = get_message(types[0]), QoSProfile(depth=10)
        self._publisher = self.create_publisher(kind, self._output, profile)
        self._subscription = self.create_subscription(kind, self._input, self.process, profile)
        self._timer.cancel()

    def process(self, message: Any) -> None:
        """Pass a message on."""
        self._publisher.publish(message)


class Throttle(Relay):
    """Passes on at most some messages a second."""

    def __init__(self) -> None:
        super().__init__("throttle")
        kind = self.declare_parameter("throttle_type", "messages").value
        if kind != "messages":
            raise SystemExit(f"throttle_type {kind!r} is not known here: only messages are counted")
        self._period = 1e9 / self.declare_parameter("msgs_per_sec", 1.0).value
        self._last = self.get_clock().now().nanoseconds

    def process(self, message: Any) -> None:
        """Pass a message on, if the last one was long enough ago."""
        now = self.get_clock().now().nanoseconds
        self._last = min(self._last, now)
        if now - self._last >= self._period:
            super().process(message)
            self._last = now


def relay() -> None:
    """Run ``relay``."""
    rclpy.init()
    rclpy.spin(Relay())


def throttle() -> None:
    """Run ``throttle``."""
    rclpy.init()
    rclpy.spin(Throttle())
