"""Waits until an action has been executed."""

from typing import Any

from drake_twin.ros2.launch.event_handlers.on_action_event_base import OnActionEventBase
from drake_twin.ros2.launch.events.execution_complete import ExecutionComplete


class OnExecutionComplete(OnActionEventBase):
    """Waits until an action has been executed."""

    waits_for = ExecutionComplete

    def __init__(self, *, target_action: Any = None, on_completion: Any = None, **more: Any):
        super().__init__(action_matcher=target_action, on_event=on_completion, **more)
