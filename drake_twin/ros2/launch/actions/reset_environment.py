"""Restores the environment that the launch was started with."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.expose import expose_action

if TYPE_CHECKING:
    from drake_twin.ros2.launch.launch_context import LaunchContext


@expose_action("reset_env")
class ResetEnvironment(Action):
    """Restores the environment that the launch was started with."""

    def execute(self, context: LaunchContext) -> None:
        """Restore the variables."""
        context.scopes.reset_environment()
