"""Restores the launch configurations that were saved last."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drake_twin.ros2.launch.action import Action

if TYPE_CHECKING:
    from drake_twin.ros2.launch.launch_context import LaunchContext


class PopLaunchConfigurations(Action):
    """Restores the launch configurations that were saved last."""

    def execute(self, context: LaunchContext) -> None:
        """Restore the configurations."""
        context.scopes.pop_configurations()
