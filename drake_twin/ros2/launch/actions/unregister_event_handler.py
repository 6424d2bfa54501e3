"""Removes an event handler."""

from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.launch_context import LaunchContext


class UnregisterEventHandler(Action):
    """Removes an event handler."""

    def __init__(self, event_handler: Any, **kwargs: Any):
        super().__init__(**kwargs)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Remove the handler."""
        context.unregister_event_handler(self.event_handler)
