"""Removes an event handler."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from drake_twin.ros2.launch.action import Action

if TYPE_CHECKING:
    from drake_twin.ros2.launch.launch_context import LaunchContext


class UnregisterEventHandler(Action):
    """Removes an event handler."""

    def __init__(self, event_handler: Any, **kwargs: Any):
        super().__init__(**kwargs)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Remove the handler."""
        context.unregister_event_handler(self.event_handler)
