"""Stand-in for ``rclpy.signals``."""

from typing import Any

from drake_twin.nodes.rclpy.guard_condition import GuardCondition
from drake_twin.nodes.rclpy.native import native_enum
from drake_twin.nodes.task import present_task

SignalHandlerOptions = native_enum(
    "SignalHandlerOptions",
    "Which signals ROS would handle; here the twin does.",
    __name__,
    NO=0,
    SIGINT=1,
    SIGTERM=2,
    ALL=3,
)


class SignalHandlerGuardCondition(GuardCondition):
    """A guard condition of signals, which the twin never triggers."""

    def __init__(self, context: Any = None):
        super().__init__(lambda: None, None, context)


def install_signal_handlers(options: Any = SignalHandlerOptions.ALL) -> None:
    """Take note of the signals: the twin ends its nodes."""
    present_task().program.rclpy["signals"] = options


def get_current_signal_handlers_options() -> Any:
    return present_task().program.rclpy.get("signals", SignalHandlerOptions.NO)


def uninstall_signal_handlers() -> None:
    present_task().program.rclpy["signals"] = SignalHandlerOptions.NO
