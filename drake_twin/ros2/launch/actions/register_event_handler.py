"""Registers and removes event handlers."""

from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.launch_context import LaunchContext


class RegisterEventHandler(Action):
    """Registers an event handler; its actions see the configurations of this moment."""

    def __init__(self, event_handler: Any, **kwargs: Any):
        super().__init__(**kwargs)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Register the handler."""
        context.register_event_handler(self.event_handler)

    def describe_conditional_sub_entities(self) -> list[tuple[str, list[Any]]]:
        """Return what the handler visits."""
        return [("the event", list(getattr(self.event_handler, "entities", ())))]


class UnregisterEventHandler(Action):
    """Removes an event handler."""

    def __init__(self, event_handler: Any, **kwargs: Any):
        super().__init__(**kwargs)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Remove the handler."""
        context.unregister_event_handler(self.event_handler)
