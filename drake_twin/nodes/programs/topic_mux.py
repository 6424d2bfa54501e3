"""``topic_tools/mux``: pass on what is published on one of several topics, which services choose.

Source: ros-tooling/topic_tools (jazzy), src/tool_base_node.cpp, src/mux_node.cpp and src/mux.cpp. ``lazy`` is not
there.
"""

import sys
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.utilities import remove_ros_args
from rosidl_runtime_py.utilities import get_message
from topic_tools_interfaces.srv import MuxAdd, MuxDelete, MuxList, MuxSelect

_DISCOVERY = 0.1  # s
_NONE = "__none"  # the topic that stands for no input


class Mux(Node):
    """The multiplexer.

    Args:
        output: The topic of what is passed on.
        inputs: The topics to choose from.
    """

    def __init__(self, output: str, inputs: list[str]):
        super().__init__("mux")
        self._output = self.declare_parameter("output_topic", output).value
        self._inputs = list(self.declare_parameter("input_topics", inputs).value)
        self._selected = self.declare_parameter("initial_topic", "").value or self._inputs[0]
        self._publisher: Any = None
        self._subscription: Any = None
        self.create_service(MuxAdd, "~/add", self._add)
        self.create_service(MuxDelete, "~/delete", self._delete)
        self.create_service(MuxList, "~/list", self._list)
        self.create_service(MuxSelect, "~/select", self._select)
        self.create_timer(_DISCOVERY, self._look)
        self._look()

    def _look(self) -> None:
        if self._selected == _NONE or not self.count_publishers(self._selected):
            return
        topic = self.resolve_topic_name(self._selected)
        kind, profile = get_message(dict(self.get_topic_names_and_types())[topic][0]), QoSProfile(depth=10)
        if self._publisher is not None and self._publisher.msg_type is not kind:
            self.destroy_publisher(self._publisher)
            self._publisher = None
        if self._publisher is None:
            self._publisher = self.create_publisher(kind, self._output, profile)
        if self._subscription is None or self._subscription.topic_name != topic:
            self._hear_nothing()
            self._subscription = self.create_subscription(kind, topic, self._publisher.publish, profile)

    def _hear_nothing(self) -> None:
        if self._subscription is not None:
            self.destroy_subscription(self._subscription)
            self._subscription = None

    def _known(self, topic: str) -> str | None:
        """Return the input that a name stands for."""
        full = self.resolve_topic_name(topic) if topic else ""
        return next((item for item in self._inputs if self.resolve_topic_name(item) == full), None)

    def _add(self, request: Any, response: Any) -> Any:
        response.success = request.topic not in ("", _NONE, *self._inputs)
        if response.success:
            self._inputs.append(request.topic)
        return response

    def _delete(self, request: Any, response: Any) -> Any:
        known = self._known(request.topic)
        response.success = known is not None and known != self._known(self._selected)
        if response.success:
            self._inputs.remove(known)
        return response

    def _list(self, request: Any, response: Any) -> Any:
        response.topics = self._inputs
        return response

    def _select(self, request: Any, response: Any) -> Any:
        response.prev_topic = self._selected if self._known(self._selected) is not None else ""
        response.success = request.topic == _NONE or self._known(request.topic) is not None
        if response.success:
            self._selected = request.topic
            self._hear_nothing()
            self._look()
        return response


def main() -> None:
    """Run the node."""
    words = remove_ros_args(sys.argv)[1:]
    if len(words) < 2:
        raise SystemExit("mux needs the output's topic and at least one of an input: OUTPUT INPUT …")
    rclpy.init()
    rclpy.spin(Mux(words[0], words[1:]))
