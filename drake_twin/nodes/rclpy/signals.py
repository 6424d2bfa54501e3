"""Stand-in for ``rclpy.signals``."""

from enum import IntEnum

from drake_twin.nodes.task import present_task


class SignalHandlerOptions(IntEnum):
    """Which signals ROS would handle; here the twin does."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


def install_signal_handlers(options: SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Take note of the signals: the twin ends its nodes."""
    present_task().program.rclpy["signals"] = options


def get_current_signal_handlers_options() -> SignalHandlerOptions:
    options: SignalHandlerOptions = present_task().program.rclpy.get("signals", SignalHandlerOptions.NO)
    return options


def uninstall_signal_handlers() -> None:
    present_task().program.rclpy["signals"] = SignalHandlerOptions.NO
