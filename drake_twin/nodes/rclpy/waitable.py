"""Stand-in for ``rclpy.waitable``."""

from math import inf
from typing import Any


class Waitable:
    """Something of a user's own for which an executor waits; it is never ready here."""

    def __init__(self, callback_group: Any):
        self.callback_group = callback_group

    def is_ready(self, wait_set: Any = None) -> bool:
        return False

    def due(self) -> float:
        return inf
