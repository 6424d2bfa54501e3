"""Saves the launch configurations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drake_twin.ros2.launch.action import Action

if TYPE_CHECKING:
    from drake_twin.ros2.launch.launch_context import LaunchContext


class PushLaunchConfigurations(Action):
    """Saves the launch configurations."""

    def execute(self, context: LaunchContext) -> None:
        """Save the configurations."""
        context.scopes.push_configurations()
