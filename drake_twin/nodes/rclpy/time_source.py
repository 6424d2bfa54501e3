"""Stand-in for ``rclpy.time_source``: it sets the clocks that a program attaches; a node's own follows the twin."""

from typing import Any

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy.clock import ROSClock
from drake_twin.nodes.rclpy.clock_type import ClockType
from drake_twin.nodes.rclpy.node import Node
from drake_twin.nodes.rclpy.parameter import Parameter
from drake_twin.nodes.rclpy.qos import QoSProfile, ReliabilityPolicy
from drake_twin.nodes.rclpy.time import Time

CLOCK_TOPIC = "/clock"
USE_SIM_TIME_NAME = "use_sim_time"


class TimeSource:
    """Sets clocks by ``/clock`` while its node's ``use_sim_time`` is true."""

    def __init__(self, *, node: Node | None = None):
        self._clock_sub: Any = None
        self._node: Node | None = None
        self._clocks: list[ROSClock] = []
        self._last_time_set = Time(clock_type=ClockType.ROS_TIME)
        self._is_active = False
        if node is not None:
            self.attach_node(node)

    @property
    def ros_time_is_active(self) -> bool:
        return self._is_active

    @ros_time_is_active.setter
    def ros_time_is_active(self, enabled: bool) -> None:
        if self._is_active == enabled:
            return
        self._is_active = enabled
        for clock in self._clocks:
            clock._set_ros_time_is_active(enabled)
        self._subscribe()

    def attach_node(self, node: Node) -> None:
        if not isinstance(node, Node):
            raise TypeError("Node must be of type rclpy.node.Node")
        if self._node is not None:
            self.detach_node()
        self._node = node
        if not node.has_parameter(USE_SIM_TIME_NAME):
            node.declare_parameter(USE_SIM_TIME_NAME, False)
        given = node.get_parameter(USE_SIM_TIME_NAME)
        if given.type_ == Parameter.Type.BOOL:
            self.ros_time_is_active = given.value
            self._subscribe()
        elif given.type_ != Parameter.Type.NOT_SET:
            text = f"Invalid type for parameter '{USE_SIM_TIME_NAME}' {given.type_!r} should be bool"
            node.get_logger().error(text)
        node.add_on_set_parameters_callback(self._on_parameters)

    def detach_node(self) -> None:
        self._unsubscribe()
        self._node = None

    def attach_clock(self, clock: ROSClock) -> None:
        if not isinstance(clock, ROSClock):
            raise ValueError("Only clocks with type ROS_TIME can be attached.")
        clock.set_ros_time_override(self._last_time_set)
        clock._set_ros_time_is_active(self._is_active)
        self._clocks.append(clock)

    def clock_callback(self, msg: Any) -> None:
        self._last_time_set = Time.from_msg(msg.clock)
        for clock in self._clocks:
            clock.set_ros_time_override(self._last_time_set)

    def _subscribe(self) -> None:
        """Subscribe to the clock while its time is active."""
        if not self._is_active:
            self._unsubscribe()
        elif self._clock_sub is None and self._node is not None:
            kind = message_class("rosgraph_msgs/msg/Clock")
            profile = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
            self._clock_sub = self._node.create_subscription(kind, CLOCK_TOPIC, self.clock_callback, profile)

    def _unsubscribe(self) -> None:
        if self._clock_sub is not None and self._node is not None:
            self._node.destroy_subscription(self._clock_sub)
        self._clock_sub = None

    def _get_node(self) -> Node | None:
        return self._node

    def _on_parameters(self, parameters: list[Parameter]) -> Any:
        result = message_class("rcl_interfaces/msg/SetParametersResult")
        for parameter in parameters:
            if parameter.name == USE_SIM_TIME_NAME:
                if parameter.type_ != Parameter.Type.BOOL:
                    reason = f"{USE_SIM_TIME_NAME} parameter set to something besides a bool"
                    return result(successful=False, reason=reason)
                self.ros_time_is_active = parameter.value
        return result(successful=True)
