"""Stand-in for ``rclpy.clock_type``."""

from enum import IntEnum


class ClockType(IntEnum):
    """The kinds of clocks, all of which show simulation time here."""

    UNINITIALIZED = 0
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3
