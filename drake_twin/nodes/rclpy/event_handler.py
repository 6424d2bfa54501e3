"""Stand-in for ``rclpy.event_handler``: its callbacks are accepted, and nothing calls them."""

from typing import Any


class _EventCallbacks:
    def __init__(self, **callbacks: Any):
        self.__dict__.update(callbacks)


class PublisherEventCallbacks(_EventCallbacks):
    """Callbacks of a publisher."""


class SubscriptionEventCallbacks(_EventCallbacks):
    """Callbacks of a subscription."""
