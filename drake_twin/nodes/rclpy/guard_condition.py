"""Stand-in for ``rclpy.guard_condition``."""

from collections.abc import Callable
from typing import Any

from drake_twin.nodes.rclpy.waitable import WaitedHandle


class GuardCondition:
    """Calls back once after each trigger."""

    def __init__(self, callback: Callable[[], Any] | None, callback_group: Any, context: Any = None):
        self.callback, self.callback_group = callback, callback_group
        self._is_triggered = False
        self._handle = WaitedHandle(self._take, lambda: self._is_triggered, self._take)

    handle = property(lambda self: self._handle)

    def trigger(self) -> None:
        self._handle.check()
        self._is_triggered = True

    def _is_ready(self) -> bool:
        return self._is_triggered

    def _take(self) -> None:
        self._is_triggered = False

    def _execute(self) -> Any:
        self._take()
        return self.callback()  # type: ignore[misc]  # as rclpy, which lets a guard without one fail here

    def destroy(self) -> None:
        self._handle.destroy_when_not_in_use()
