"""Stand-in for ``rclpy.clock``: all clocks show simulation time."""

from collections.abc import Callable
from enum import IntEnum
from typing import Any

from drake_twin.nodes.rclpy.clock_type import ClockType
from drake_twin.nodes.rclpy.duration import Duration
from drake_twin.nodes.rclpy.time import Time
from drake_twin.nodes.task import present_task


class ClockChange(IntEnum):
    """What becomes of a clock's source."""

    ROS_TIME_NO_CHANGE = 1
    ROS_TIME_ACTIVATED = 2
    ROS_TIME_DEACTIVATED = 3
    SYSTEM_TIME_NO_CHANGE = 4


class JumpThreshold:
    """How far a clock must jump for a callback."""

    def __init__(self, *, min_forward: Any, min_backward: Any, on_clock_change: bool = True):
        self.min_forward, self.min_backward, self.on_clock_change = min_forward, min_backward, on_clock_change


class TimeJump:
    """A jump of a clock."""

    def __init__(self, clock_change: ClockChange, delta: Duration):
        self.clock_change, self.delta = clock_change, delta


class JumpHandle:
    """Callbacks of a clock that jumps."""

    def __init__(self, clock: "Clock", pre_callback: Any, post_callback: Any):
        self._clock, self.pre_callback, self.post_callback = clock, pre_callback, post_callback

    def unregister(self) -> None:
        if self in self._clock.jump_handles:
            self._clock.jump_handles.remove(self)

    def __enter__(self) -> "JumpHandle":
        return self

    def __exit__(self, *_: object) -> None:
        self.unregister()


class Clock:
    """A clock."""

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> "Clock":
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        return super().__new__(ROSClock if clock_type is ClockType.ROS_TIME else cls)

    def __init__(self, *, clock_type: ClockType = ClockType.SYSTEM_TIME):
        self._clock_type = clock_type
        self.jump_handles: list[JumpHandle] = []

    @property
    def clock_type(self) -> ClockType:
        return self._clock_type

    def now(self) -> Time:
        return Time(nanoseconds=present_task().now, clock_type=self._clock_type)

    def sleep_until(self, until: Time, context: Any = None) -> bool:
        """Sleep until a time; return whether it has come."""
        if not isinstance(until, Time):
            raise TypeError("Must pass a Time object")
        if until.clock_type != self._clock_type:
            raise ValueError("until's clock type does not match this clock's type")
        return self.sleep_for(Duration(nanoseconds=until.nanoseconds - present_task().now), context)

    def sleep_for(self, rel_time: Duration, context: Any = None) -> bool:
        """Sleep for a span of time; return whether it has passed."""
        task = present_task()
        if rel_time.nanoseconds > 0:
            task.sleep(max(task.after, task.now + rel_time.nanoseconds))
        return True

    def create_jump_callback(
        self, threshold: JumpThreshold, *, pre_callback: Callable[..., Any] | None = None, post_callback: Any = None
    ) -> JumpHandle:
        handle = JumpHandle(self, pre_callback, post_callback)
        self.jump_handles.append(handle)
        return handle

    def __repr__(self) -> str:
        return f"Clock(clock_type={self.clock_type.name})"


class ROSClock(Clock):
    """The clock of a node."""

    def __new__(cls, *_: Any, **__: Any) -> "ROSClock":
        return object.__new__(cls)

    def __init__(self, *, clock_type: ClockType = ClockType.ROS_TIME):
        super().__init__(clock_type=ClockType.ROS_TIME)

    @property
    def ros_time_is_active(self) -> bool:
        return True
