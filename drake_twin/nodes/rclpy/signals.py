"""Stand-in for ``rclpy.signals``."""

from enum import IntEnum


class SignalHandlerOptions(IntEnum):
    """Which signals ROS would handle; here the twin does."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


def install_signal_handlers(options: SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Do nothing: the twin ends its nodes."""


def uninstall_signal_handlers() -> None:
    """Do nothing."""
