"""Stand-in for ``rclpy.impl.logging_severity``."""

from drake_twin.nodes.rclpy.logging import LoggingSeverity

__all__ = ["LoggingSeverity"]
