"""Waits for a request to include a launch description."""

from typing import Any

from drake_twin.ros2.launch.event_handler import EventHandler
from drake_twin.ros2.launch.events.include_launch_description import IncludeLaunchDescription


class OnIncludeLaunchDescription(EventHandler):
    """Waits for a request to include a launch description."""

    waits_for = IncludeLaunchDescription

    def __init__(self, **more: Any):
        super().__init__(matcher=lambda event: isinstance(event, IncludeLaunchDescription), **more)
