"""``topic_tools/relay``, ``throttle``, ``drop`` and ``delay``: pass on what is published on a topic to another one.

Source: ros-tooling/topic_tools (jazzy), src/tool_base_node.cpp and the file of each. They look for the input every
0.1 s. ``lazy`` and the throttle by bytes are not there.
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
    """Passes messages on.

    Args:
        name: The name of the node.
        order: The parameters that the words of its command line are, in their order.
    """

    def __init__(self, name: str = "relay", order: tuple[str, ...] = ("input_topic", "output_topic")):
        super().__init__(name)
        words = [word for word in remove_ros_args(sys.argv)[1:] if not word.startswith("-")]
        own = self._words = dict(zip(order, words, strict=False))
        self._input = self.declare_parameter("input_topic", own.get("input_topic", "")).value
        if not self._input:
            raise SystemExit("the parameter input_topic is not set")
        default = own.get("output_topic", f"{self._input}_{name}")
        self._output = self.declare_parameter("output_topic", default).value
        self.declare_parameter("lazy", False)
        self._publisher: Any = None
        self._timer = self.create_timer(_DISCOVERY, self._discover)
        self._discover()

    def _own(self, name: str, kind: Any, default: Any) -> Any:
        """Return a parameter that may also stand on the command line."""
        return self.declare_parameter(name, kind(self._words[name]) if name in self._words else default).value

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
        super().__init__("throttle", ("throttle_type", "input_topic", "msgs_per_sec", "output_topic"))
        kind = self._own("throttle_type", str, "messages")
        if kind != "messages":
            raise SystemExit(f"throttle_type {kind!r} is not known here: only messages are counted")
        self._period = 1e9 / self._own("msgs_per_sec", float, 1.0)
        self._last = self.get_clock().now().nanoseconds

    def process(self, message: Any) -> None:
        """Pass a message on, if the last one was long enough ago."""
        now = self.get_clock().now().nanoseconds
        self._last = min(self._last, now)
        if now - self._last >= self._period:
            super().process(message)
            self._last = now


class Drop(Relay):
    """Drops the first X of every Y messages."""

    def __init__(self) -> None:
        super().__init__("drop", ("input_topic", "X", "Y", "output_topic"))
        self._dropped, self._all = (self._own(name, int, -1) for name in ("X", "Y"))
        if min(self._dropped, self._all) < 0:
            raise SystemExit(f"the parameter {'X' if self._dropped < 0 else 'Y'} is not set")
        self._count = 0

    def process(self, message: Any) -> None:
        """Pass a message on, if it is not dropped."""
        if self._count >= self._dropped:
            super().process(message)
        self._count += 1
        if self._count >= self._all:
            self._count = 0


class Delay(Relay):
    """Passes messages on after some time."""

    def __init__(self) -> None:
        super().__init__("delay", ("input_topic", "delay", "output_topic"))
        self._delay = self._own("delay", float, 0.0)
        self.declare_parameter("use_wall_clock", False)

    def process(self, message: Any) -> None:
        """Pass a message on later."""
        timer: Any = self.create_timer(self._delay, lambda: self._pass_on(timer, message))

    def _pass_on(self, timer: Any, message: Any) -> None:
        self.destroy_timer(timer)
        super().process(message)


def drop() -> None:
    """Run ``drop``."""
    rclpy.init()
    rclpy.spin(Drop())


def delay() -> None:
    """Run ``delay``."""
    rclpy.init()
    rclpy.spin(Delay())


def relay() -> None:
    """Run ``relay``."""
    rclpy.init()
    rclpy.spin(Relay())


def throttle() -> None:
    """Run ``throttle``."""
    rclpy.init()
    rclpy.spin(Throttle())
