"""The types of rclpy's annotations for what is C++ there."""

from typing import Any, Protocol, TypedDict

from drake_twin.nodes.rclpy.destroyable import DestroyableType


class ContextHandle(DestroyableType, Protocol):
    def ok(self) -> bool: ...

    def get_domain_id(self) -> int: ...

    def shutdown(self) -> None: ...


class ClockHandle(DestroyableType, Protocol):
    def get_now(self) -> Any: ...

    def get_ros_time_override_is_enabled(self) -> bool: ...

    def set_ros_time_override_is_enabled(self, enabled: bool) -> None: ...

    def set_ros_time_override(self, time_point: Any) -> None: ...

    def add_clock_callback(
        self, pyjump_handle: Any, on_clock_change: bool, min_forward: int, min_backward: int
    ) -> None: ...

    def remove_clock_callback(self, pyjump_handle: Any) -> None: ...


class TimeHandle(Protocol):
    nanoseconds: int
    clock_type: Any


class DurationType(Protocol):
    nanoseconds: int


class TimeJumpDictionary(TypedDict):
    clock_change: Any
    delta: int
