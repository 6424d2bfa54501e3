"""A timer is due."""

from typing import Any

from drake_twin.ros2.launch.event import Event


class TimerEvent(Event):
    """A timer is due."""

    name = "launch.events.TimerEvent"

    def __init__(self, *, timer_action: Any):
        self.timer_action = timer_action
