"""Stand-in for ``rclpy.context``."""

import sys
from collections.abc import Callable, Sequence
from typing import Any

from drake_twin.nodes.rclpy._rclpy_pybind11 import RCLError, RCLInvalidROSArgsError, UnknownROSArgsError
from drake_twin.nodes.rclpy.handle import Handle
from drake_twin.nodes.rclpy.impl.logging_levels import get_logging_severity_from_string, set_logger_level
from drake_twin.nodes.task import here, present_task
from drake_twin.ros2.ros_arguments import (
    RosArguments,
    RosArgumentsError,
    UnknownRosArgumentsError,
    check_ros_arguments,
    split_ros_arguments,
)


class Context:
    """Between ``init`` and ``shutdown``."""

    def __init__(self) -> None:
        self.is_valid = self._has_begun = False
        self._domain_id = 0
        self.arguments = RosArguments(())
        self._callbacks: list[Callable[[], Any]] = []
        self._handle = Handle()

    def init(
        self, args: Sequence[str] | None = None, *, initialize_logging: bool = True, domain_id: int | None = None
    ) -> None:
        if domain_id is not None and domain_id < 0:
            raise RuntimeError(f"Domain id ({domain_id}) should not be lower than zero.")
        if self._has_begun:
            raise RuntimeError("Context.init() must only be called once")
        words = list(sys.argv if args is None else args)
        for word in words:
            word.encode()
        self.arguments = checked_arguments(words, RCLError)
        for name, level in self.arguments.log_levels:
            set_logger_level(name, get_logging_severity_from_string(level))
        self.is_valid = self._has_begun = True
        self._domain_id = domain_id or 0

    def ok(self) -> bool:
        task = here()
        if task is not None:
            task.count_call()
        return self.is_valid

    def on_shutdown(self, callback: Callable[[], Any]) -> None:
        if not callable(callback):
            raise TypeError("callback should be a callable, got {}", type(callback))
        if self._has_begun and not self.is_valid:
            callback()
        else:
            self._callbacks.append(callback)

    def try_shutdown(self) -> None:
        if self.is_valid:
            self.is_valid = False
            callbacks, self._callbacks = self._callbacks, []
            for callback in callbacks:
                callback()

    def shutdown(self) -> None:
        if not self.is_valid:
            raise RuntimeError("Context must be initialized before it can be shutdown")
        self.try_shutdown()

    def get_domain_id(self) -> int:
        if not self._has_begun:
            raise RuntimeError("Context must be initialized before it can have a domain id")
        return self._domain_id

    def destroy(self) -> None:
        """Do nothing more: it has no other resources than those that end with it."""

    @property
    def handle(self) -> Handle:
        return self._handle

    def __enter__(self) -> "Context":
        self.init()
        return self

    def __exit__(self, exc_type: Any, exc_val: Any, exc_tb: Any) -> None:
        self.try_shutdown()


def checked_arguments(words: Sequence[str], error_class: type[RCLError]) -> RosArguments:
    """Return a command line's arguments.

    Raises:
        RCLError: If rcl refuses one, of the class that is given.
        UnknownROSArgsError: If one is unknown.
    """
    try:
        check_ros_arguments(words)
    except RosArgumentsError as error:
        what = "Failed to parse ROS arguments" if error_class is RCLInvalidROSArgsError else "failed to initialize rcl"
        raise error_class(f"{what}: {error}") from None
    except UnknownRosArgumentsError as error:
        raise UnknownROSArgsError(str(error)) from None
    return split_ros_arguments(words)


def default_context(*, shutting_down: bool = False) -> Context:
    """Return the context of the program, which is another one after it has been shut down."""
    known = present_task().program.rclpy
    if "context" not in known:
        known["context"] = Context()
    context: Context = known["context"]
    if shutting_down:
        del known["context"]
    return context
