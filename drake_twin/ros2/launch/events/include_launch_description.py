"""A launch description is to be included."""

from typing import Any

from drake_twin.ros2.launch.event import Event


class IncludeLaunchDescription(Event):
    """A launch description is to be included."""

    name = "launch.events.IncludeLaunchDescription"

    def __init__(self, launch_description: Any):
        self.launch_description = launch_description
