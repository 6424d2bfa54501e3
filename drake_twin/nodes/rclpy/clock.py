"""Stand-in for ``rclpy.clock``: all clocks show simulation time."""

import typing
from collections import deque
from collections.abc import Callable
from enum import IntEnum
from functools import partial
from operator import attrgetter
from typing import Any

from drake_twin.nodes.rclpy.callback_groups import ReentrantCallbackGroup
from drake_twin.nodes.rclpy.clock_type import ClockType
from drake_twin.nodes.rclpy.context import default_context
from drake_twin.nodes.rclpy.duration import Duration
from drake_twin.nodes.rclpy.exceptions import NotInitializedException
from drake_twin.nodes.rclpy.handle import Handle
from drake_twin.nodes.rclpy.time import Time
from drake_twin.nodes.task import present_task


class ClockChange(IntEnum):
    """What becomes of a clock's source."""

    ROS_TIME_NO_CHANGE = 1
    ROS_TIME_ACTIVATED = 2
    ROS_TIME_DEACTIVATED = 3
    SYSTEM_TIME_NO_CHANGE = 4


JumpHandlePreCallbackType = typing.Callable[[], None]


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

    def _is_exceeded(self, change: ClockChange, delta: int) -> bool:
        """Return whether a jump of some nanoseconds is so far, or a change of the source of time counts."""
        if change in (ClockChange.ROS_TIME_ACTIVATED, ClockChange.ROS_TIME_DEACTIVATED):
            return self.on_clock_change
        forward, backward = self.min_forward, self.min_backward
        is_forward = forward is not None and delta >= forward.nanoseconds
        return is_forward or (backward is not None and delta <= backward.nanoseconds)


class TimeJump:
    """A jump of a clock."""

    def __init__(self, clock_change: ClockChange, delta: Duration):
        if not isinstance(clock_change, ClockChange):
            raise TypeError("clock_change must be an instance of rclpy.clock.ClockChange")
        self._clock_change, self._delta = clock_change, delta

    clock_change = property(attrgetter("_clock_change"))
    delta = property(attrgetter("_delta"))


class JumpHandle:
    """Callbacks of a clock that jumps."""

    def __init__(self, *, clock: "Clock", threshold: JumpThreshold, pre_callback: Any, post_callback: Any):
        if pre_callback is None and post_callback is None:
            raise ValueError("One of pre_callback or post_callback must be callable")
        if pre_callback is not None and not callable(pre_callback):
            raise ValueError("pre_callback must be callable if given")
        self._clock, self.threshold = clock, threshold
        self.pre_callback, self.post_callback = pre_callback, post_callback
        clock.jump_handles.append(self)

    def unregister(self) -> None:
        if self in self._clock.jump_handles:
            self._clock.jump_handles.remove(self)

    def __enter__(self) -> "JumpHandle":
        return self

    def __exit__(self, t: Any, v: Any, tb: Any) -> None:
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

    def _is_ready(self) -> bool:
        return bool(self._waiting)

    def _execute(self) -> None:
        """Call back after a jump; ROS calls the first callback before it."""
        self._clock._jump(ClockChange.ROS_TIME_NO_CHANGE, self._waiting.popleft())

    def destroy(self) -> None:
        self._waiting.clear()


class Clock:
    """A clock; time jumps for that of a node, at a reset, and its callbacks are called at the node's next spin."""

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> "Clock":
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        self = object.__new__(ROSClock if clock_type is ClockType.ROS_TIME and cls is Clock else cls)
        self._clock_type = clock_type
        self.jump_handles = []
        self._handle = Handle()
        return self

    _clock_type: ClockType
    jump_handles: list[JumpHandle]
    _handle: Handle

    @property
    def handle(self) -> Handle:
        return self._handle

    @property
    def clock_type(self) -> ClockType:
        return self._clock_type

    @property
    def _nanoseconds(self) -> int:
        """The present time (ns)."""
        return present_task().now

    def now(self) -> Time:
        return Time(nanoseconds=self._nanoseconds, clock_type=self._clock_type)

    def sleep_until(self, until: Time, context: Any = None) -> bool:
        """Sleep until a time; return whether it has come."""
        context = context or default_context()
        if not context.is_valid:
            raise NotInitializedException
        if until.clock_type != self._clock_type:
            raise ValueError("until's clock type does not match this clock's type")
        return self._sleep(until.nanoseconds, context)

    def sleep_for(self, rel_time: Duration, context: Any = None) -> bool:
        """Sleep for a span of time; return whether it has passed."""
        if not isinstance(rel_time, Duration):
            raise TypeError("Must pass a Duration object")
        context = context or default_context()
        if not context.is_valid:
            raise NotInitializedException
        return self._sleep(self._nanoseconds + rel_time.nanoseconds, context)

    def _sleep(self, until: int, context: Any) -> bool:
        task = present_task()
        if until > task.now:
            task.wait(lambda: not context.is_valid, max(task.after, until))
        return bool(context.is_valid)

    def _jump(self, change: ClockChange, delta: int, act: Callable[[], None] = lambda: None) -> None:
        """Let something happen between the callbacks of a jump of some nanoseconds."""
        handles = [handle for handle in self.jump_handles if handle.threshold._is_exceeded(change, delta)]
        for handle in handles:
            if handle.pre_callback is not None:
                handle.pre_callback()
        act()
        for handle in handles:
            if handle.post_callback is not None:
                handle.post_callback(TimeJump(change, Duration(nanoseconds=delta)))

    def create_jump_callback(
        self, threshold: JumpThreshold, *, pre_callback: Callable[..., Any] | None = None, post_callback: Any = None
    ) -> JumpHandle:
        called = post_callback if callable(post_callback) else None
        return JumpHandle(clock=self, threshold=threshold, pre_callback=pre_callback, post_callback=called)

    def __repr__(self) -> str:
        return f"Clock(clock_type={self.clock_type.name})"


class ROSClock(Clock):
    """A clock whose time a program can set; until then it shows simulation time, active or not.

    That of a node is active from the start, and follows the twin.
    """

    _is_active = False
    _override: int | None = None

    def __new__(cls) -> "ROSClock":
        self = super().__new__(cls, clock_type=ClockType.ROS_TIME)
        assert isinstance(self, ROSClock)
        return self

    @property
    def ros_time_is_active(self) -> bool:
        return self._is_active

    @property
    def _nanoseconds(self) -> int:
        """The present time (ns): what has been set, while that is active."""
        now = present_task().now
        return now if self._override is None or not self._is_active else self._override

    def _follow_twin(self) -> None:
        """Show the twin's time as the active one."""
        self._is_active = True

    def _set_ros_time_is_active(self, enabled: bool) -> None:
        if enabled != self._is_active:
            before, self._is_active = self._nanoseconds, enabled
            delta, self._is_active = self._nanoseconds - before, not enabled
            change = ClockChange.ROS_TIME_ACTIVATED if enabled else ClockChange.ROS_TIME_DEACTIVATED
            self._jump(change, delta, lambda: setattr(self, "_is_active", enabled))

    def set_ros_time_override(self, time: Time) -> None:
        if not isinstance(time, Time):
            raise TypeError(f"Time must be specified as rclpy.time.Time. Received type: {type(time)}")
        if self._is_active:
            delta = time.nanoseconds - self._nanoseconds
            set_it = partial(setattr, self, "_override", time.nanoseconds)
            self._jump(ClockChange.ROS_TIME_NO_CHANGE, delta, set_it)
        else:
            self._override = time.nanoseconds

    def _sleep(self, until: int, context: Any) -> bool:
        was_active = self._is_active
        if was_active and self._override is not None:
            present_task().wait(
                lambda: not context.is_valid or self._is_active != was_active or (self._override or 0) >= until
            )
        elif until > (task := present_task()).now:
            task.wait(lambda: not context.is_valid or self._is_active != was_active, max(task.after, until))
        return bool(context.is_valid) and self._is_active == was_active and self._nanoseconds >= until
