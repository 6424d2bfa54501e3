"""Stand-in for ``rclpy.waitable``."""

from typing import Any


class Waitable:
    """Something of a user's own for which an executor waits: the twin has no wait sets that it could be in."""

    def __init__(self, callback_group: Any):
        raise NotImplementedError("rclpy.waitable.Waitable: the twin's executors wait for no waitable of a node's own")
