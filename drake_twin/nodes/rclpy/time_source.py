"""Stand-in for ``rclpy.time_source``: the simulation's time, which all clocks have anyway."""

from typing import Any

from drake_twin.nodes.rclpy.clock import ROSClock

CLOCK_TOPIC = "/clock"
USE_SIM_TIME_NAME = "use_sim_time"


class TimeSource:
    """Gives clocks their time."""

    def __init__(self, *, node: Any = None):
        self._node: Any = None
        self._clocks: list[ROSClock] = []
        if node is not None:
            self.attach_node(node)

    @property
    def ros_time_is_active(self) -> bool:
        return self._node is not None

    def attach_node(self, node: Any) -> None:
        self._node = node
        if not node.has_parameter(USE_SIM_TIME_NAME):
            node.declare_parameter(USE_SIM_TIME_NAME, True)

    def detach_node(self) -> None:
        self._node = None

    def attach_clock(self, clock: Any) -> None:
        if not isinstance(clock, ROSClock):
            raise ValueError("Only clocks with type ROS_TIME can be attached.")
        self._clocks.append(clock)

    def clock_callback(self, msg: Any) -> None:
        raise NotImplementedError("TimeSource.clock_callback: the twin's clocks show its time, and take no other one")
