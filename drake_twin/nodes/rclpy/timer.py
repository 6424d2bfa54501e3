"""Stand-in for ``rclpy.timer``, with ``Rate``."""

from collections.abc import Callable
from math import inf
from typing import Any

from drake_twin.nodes.rclpy.exceptions import ROSInterruptException
from drake_twin.nodes.rclpy.waitable import WaitedHandle
from drake_twin.nodes.task import Task, present_task


class Timer:
    """Calls back at a period of simulation time.

    Args:
        callback: Is called.
        callback_group: Its group.
        timer_period_ns: The period (ns).
        clock: The clock, which is the simulation's.
        autostart: Whether it runs at once.
    """

    def __init__(
        self,
        callback: Callable[[], Any] | None,
        callback_group: Any,
        timer_period_ns: int,
        clock: Any,
        *,
        context: Any = None,
        autostart: bool = True,
    ):
        self.callback, self.callback_group, self._clock = callback, callback_group, clock
        self._period = int(timer_period_ns)
        self._task: Task = present_task()
        self._last = self._task.now
        self._next = self._later(self._last + self._period)
        self._is_canceled = not autostart
        self._handle = WaitedHandle(lambda: setattr(self, "_is_canceled", True), self._is_ready)

    handle = property(lambda self: self._handle)
    clock = property(lambda self: self._clock)

    @property
    def timer_period_ns(self) -> int:
        self._handle.check()
        return self._period

    @timer_period_ns.setter
    def timer_period_ns(self, value: int) -> None:
        self._handle.check()
        self._period = int(value)
        self._next = self._later(self._last + self._period)

    def is_ready(self) -> bool:
        self._handle.check()
        return self._is_ready()

    def _is_ready(self) -> bool:
        return not self._is_canceled and self._next <= self._task.limit

    def _due(self) -> float:
        return inf if self._is_canceled else self._next

    def _execute(self) -> Any:
        now = self._task.now
        self._last = now
        self._next += self._period
        if self._next <= self._task.limit:  # periods have been missed, or it is shorter than a step
            missed = (now - self._next) // self._period + 1 if self._period else 0
            self._next = self._later(self._next + missed * self._period)
        return self.callback()  # type: ignore[misc]  # as rclpy, which lets a timer without one fail here

    def cancel(self) -> None:
        self._handle.check()
        self._is_canceled = True

    def reset(self) -> None:
        self._handle.check()
        self._is_canceled = False
        self._next = self._later(present_task().now + self._period)

    def _jump(self) -> None:
        """Follow a jump of time back: it counts from there."""
        self._last = self._task.now
        self._next = self._later(self._last + self._period)

    def is_canceled(self) -> bool:
        self._handle.check()
        return self._is_canceled

    def time_since_last_call(self) -> int:
        self._handle.check()
        return present_task().now - self._last

    def time_until_next_call(self) -> int | None:
        self._handle.check()
        return None if self._is_canceled else int(self._next - present_task().now)

    def destroy(self) -> None:
        self._handle.destroy_when_not_in_use()

    def _later(self, time: int) -> int:
        return time if time > self._task.limit else max(time, self._task.after)


class Rate:
    """Sleeps until the next period of a timer, which runs only while a thread spins, as in ROS."""

    def __init__(self, timer: Timer, *, context: Any):
        self.timer, self._context = timer, context
        self._is_destroyed = False
        self._count = 0  # of the timer's calls
        timer.callback = self._wake

    def _wake(self) -> None:
        self._count += 1

    def sleep(self) -> None:
        """Wait for the timer."""
        if not self._context.ok():
            raise ROSInterruptException
        if self._is_destroyed:
            raise RuntimeError("Rate cannot sleep because it has been destroyed")
        self.timer.handle.check()
        count = self._count
        present_task().wait(lambda: self._count > count or self._is_destroyed or not self._context.is_valid)
        if not self._context.is_valid:
            raise ROSInterruptException

    def destroy(self) -> None:
        self._is_destroyed = True
