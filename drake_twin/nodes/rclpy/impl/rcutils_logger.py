"""Stand-in for ``rclpy.impl.rcutils_logger``."""

from drake_twin.nodes.rclpy.logging import RcutilsLogger

__all__ = ["RcutilsLogger"]
