"""Stand-in for ``rclpy.guard_condition``."""

from collections.abc import Callable
from typing import Any


class GuardCondition:
    """Calls back once after each trigger."""

    def __init__(self, callback: Callable[[], Any] | None, callback_group: Any, context: Any = None):
        self.callback, self.callback_group = callback, callback_group
        self._is_triggered = False

    def trigger(self) -> None:
        self._is_triggered = True

    def is_ready(self) -> bool:
        return self._is_triggered

    def execute(self) -> Any:
        self._is_triggered = False
        return None if self.callback is None else self.callback()

    def destroy(self) -> None:
        self._is_triggered = False
