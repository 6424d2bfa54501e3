"""Emits an event."""

from typing import Any

from drake_twin.ros2.event_effects import emit
from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.launch_context import LaunchContext


class EmitEvent(Action):
    """Emits an event."""

    def __init__(self, *, event: Any, **kwargs: Any):
        super().__init__(**kwargs)
        self.event = event

    def execute(self, context: LaunchContext) -> None:
        """Emit the event after those that are due before it."""
        event = self.event
        context.events.after(0.0, lambda: emit(context, event))
