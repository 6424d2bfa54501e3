"""Waits until a process has started."""

from typing import Any

from drake_twin.ros2.launch.event_handlers.on_action_event_base import OnActionEventBase
from drake_twin.ros2.launch.events.process import ProcessStarted


class OnProcessStart(OnActionEventBase):
    """Waits until a process has started."""

    waits_for = ProcessStarted

    def __init__(self, *, target_action: Any = None, on_start: Any = None, **more: Any):
        super().__init__(action_matcher=target_action, on_event=on_start, **more)
