"""Stand-in for ``rclpy.clock``: all clocks show simulation time."""

from collections import deque
from collections.abc import Callable
from enum import IntEnum
from typing import Any

from drake_twin.nodes.rclpy.callback_groups import ReentrantCallbackGroup
from drake_twin.nodes.rclpy.clock_type import ClockType
from drake_twin.nodes.rclpy.context import default_context
from drake_twin.nodes.rclpy.duration import Duration
from drake_twin.nodes.rclpy.exceptions import NotInitializedException
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

    def __init__(self, *, min_forward: Duration | None, min_backward: Duration | None, on_clock_change: bool = True):
        if min_forward is not None and min_forward.nanoseconds <= 0:
            raise ValueError("min_forward must be a positive non-zero duration")
        if min_backward is not None and min_backward.nanoseconds >= 0:
            raise ValueError("min_backward must be a negative non-zero duration")
        if min_forward is None and min_backward is None and not on_clock_change:
            raise ValueError("At least one jump threshold must be enabled")
        self.min_forward, self.min_backward, self.on_clock_change = min_forward, min_backward, on_clock_change

    def is_exceeded(self, delta: int) -> bool:
        """Return whether a jump of some nanoseconds is so far; the source of time never changes here."""
        forward, backward = self.min_forward, self.min_backward
        is_forward = forward is not None and delta >= forward.nanoseconds
        return is_forward or (backward is not None and delta <= backward.nanoseconds)


class TimeJump:
    """A jump of a clock."""

    def __init__(self, clock_change: ClockChange, delta: Duration):
        self.clock_change, self.delta = clock_change, delta


class JumpHandle:
    """Callbacks of a clock that jumps."""

    def __init__(self, *, clock: "Clock", threshold: JumpThreshold, pre_callback: Any, post_callback: Any):
        self._clock, self._threshold = clock, threshold
        self._pre_callback, self._post_callback = pre_callback, post_callback

    def jump(self, delta: int) -> None:
        """Call back after a jump of some nanoseconds, if it is far enough; ROS calls the first one before it."""
        if not self._threshold.is_exceeded(delta):
            return
        if self._pre_callback is not None:
            self._pre_callback()
        if self._post_callback is not None:
            self._post_callback(TimeJump(ClockChange.ROS_TIME_NO_CHANGE, Duration(nanoseconds=delta)))

    def unregister(self) -> None:
        if self in self._clock.jump_handles:
            self._clock.jump_handles.remove(self)

    def __enter__(self) -> "JumpHandle":
        return self

    def __exit__(self, *_: object) -> None:
        self.unregister()


class Jumps:
    """The jumps of a clock that an executor has still to tell its callbacks of.

    Args:
        clock: The clock.
    """

    def __init__(self, clock: "Clock"):
        self._clock = clock
        self._waiting: deque[int] = deque()
        self.callback_group = ReentrantCallbackGroup()

    def put(self, delta: int) -> None:
        """Add a jump of some nanoseconds."""
        self._waiting.append(delta)

    def is_ready(self) -> bool:
        return bool(self._waiting)

    def execute(self) -> None:
        delta = self._waiting.popleft()
        for handle in list(self._clock.jump_handles):
            handle.jump(delta)

    def destroy(self) -> None:
        self._waiting.clear()


class Clock:
    """A clock; time jumps for that of a node, at a reset, and its callbacks are called at the node's next spin."""

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
        context = context or default_context()
        if not context.is_valid:
            raise NotInitializedException
        task = present_task()
        if rel_time.nanoseconds > 0:
            until = max(task.after, task.now + rel_time.nanoseconds)
            task.wait(lambda: not context.is_valid, until)
        return bool(context.is_valid)

    def create_jump_callback(
        self, threshold: JumpThreshold, *, pre_callback: Callable[..., Any] | None = None, post_callback: Any = None
    ) -> JumpHandle:
        handle = JumpHandle(clock=self, threshold=threshold, pre_callback=pre_callback, post_callback=post_callback)
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
