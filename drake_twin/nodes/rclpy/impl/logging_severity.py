"""Stand-in for ``rclpy.impl.logging_severity``."""

from enum import IntEnum


class LoggingSeverity(IntEnum):
    """How grave a line is."""

    UNSET = 0
    DEBUG = 10
    INFO = 20
    WARN = 30
    ERROR = 40
    FATAL = 50
