"""Stand-in for ``rclpy.timer``, with ``Rate``."""

from collections.abc import Callable
from math import inf
from typing import Any

from drake_twin.nodes.rclpy.exceptions import ROSInterruptException
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
        self.callback, self.callback_group, self.clock = callback, callback_group, clock
        self._period = int(timer_period_ns)
        self._task: Task = present_task()
        self._last = self._task.now
        self._next = self._later(self._last + self._period)
        self._is_canceled = not autostart

    @property
    def timer_period_ns(self) -> int:
        return self._period

    @timer_period_ns.setter
    def timer_period_ns(self, value: int) -> None:
        self._period = int(value)
        self._next = self._later(self._last + self._period)

    def is_ready(self) -> bool:
        return not self._is_canceled and self._next <= self._task.limit

    def due(self) -> float:
        return inf if self._is_canceled else self._next

    def execute(self) -> Any:
        now = self._task.now
        self._last = now
        self._next += self._period
        if self._next <= self._task.limit:  # periods have been missed, or it is shorter than a step
            missed = (now - self._next) // self._period + 1 if self._period else 0
            self._next = self._later(self._next + missed * self._period)
        return None if self.callback is None else self.callback()

    def cancel(self) -> None:
        self._is_canceled = True

    def reset(self) -> None:
        self._is_canceled = False
        self._next = self._later(present_task().now + self._period)

    def jump(self) -> None:
        """Follow a jump of time back: it counts from there."""
        self._last = self._task.now
        self._next = self._later(self._last + self._period)

    def is_canceled(self) -> bool:
        return self._is_canceled

    def time_since_last_call(self) -> int:
        return present_task().now - self._last

    def time_until_next_call(self) -> int | None:
        return None if self._is_canceled else int(self._next - present_task().now)

    def destroy(self) -> None:
        self._is_canceled = True

    def _later(self, time: int) -> int:
        return time if time > self._task.limit else max(time, self._task.after)


class Rate:
    """Sleeps until the next period of a timer."""

    def __init__(self, timer: Timer, *, context: Any):
        self._timer, self._context = timer, context
        self._is_destroyed = False

    def sleep(self) -> None:
        """Wait for the timer, which runs only while a thread spins, as in ROS."""
        if self._is_destroyed:
            raise RuntimeError("Rate cannot sleep because it has been destroyed")
        if not self._context.ok():
            raise ROSInterruptException
        task = present_task()
        due = self._timer.due()
        task.sleep(due)
        if self._timer.is_ready():
            self._timer.execute()

    def destroy(self) -> None:
        self._is_destroyed = True
        self._timer.destroy()
