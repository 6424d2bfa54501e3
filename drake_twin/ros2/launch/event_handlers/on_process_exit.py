"""Waits until a process has ended."""

from typing import Any

from drake_twin.ros2.launch.event_handlers.on_action_event_base import OnActionEventBase
from drake_twin.ros2.launch.events.process import ProcessExited


class OnProcessExit(OnActionEventBase):
    """Waits until a process has ended."""

    waits_for = ProcessExited

    def __init__(self, *, target_action: Any = None, on_exit: Any = None, **more: Any):
        super().__init__(action_matcher=target_action, on_event=on_exit, **more)
