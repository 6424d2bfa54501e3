"""What launch files import for being started as programs or tests, and never use when they are included."""

from __future__ import annotations

from typing import Any

from drake_twin.errors import InputError
from drake_twin.ros2.entity import Action


class LaunchService:
    """ROS's own runner of launch descriptions, which a launch file may import but not use here."""

    def __init__(self, *args: Any, **kwargs: Any):
        raise InputError("the launch file starts a launch service of its own, where it should only describe the launch")


class LaunchIntrospector:
    """Describes launch descriptions."""

    def format_launch_description(self, launch_description: Any) -> str:
        """The entities, one a line."""
        return "\n".join(entity.describe() for entity in launch_description.entities)


class ReadyToTest(Action):
    """Tells launch_testing that the tests may begin; nothing here."""
