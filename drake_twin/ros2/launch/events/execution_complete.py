"""An action has been executed."""

from typing import Any

from drake_twin.ros2.launch.event import Event


class ExecutionComplete(Event):
    """An action has been executed."""

    name = "launch.events.ExecutionComplete"

    def __init__(self, *, action: Any):
        self.action = action
