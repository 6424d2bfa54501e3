"""Waits for the end of the launch."""

from typing import Any

from drake_twin.ros2.launch.event_handler import EventHandler
from drake_twin.ros2.launch.events.shutdown import Shutdown


class OnShutdown(EventHandler):
    """Waits for the end of the launch."""

    waits_for = Shutdown

    def __init__(self, *, on_shutdown: Any = None, **more: Any):
        super().__init__(matcher=lambda event: isinstance(event, Shutdown), entities=on_shutdown, **more)
