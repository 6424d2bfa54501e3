"""Stand-in for ``rclpy.qos_event``, the older name of ``rclpy.event_handler``."""

from drake_twin.nodes.rclpy.event_handler import *  # noqa: F403
