"""Restores the launch configurations that were saved last."""

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.launch_context import LaunchContext


class PopLaunchConfigurations(Action):
    """Restores the launch configurations that were saved last."""

    def execute(self, context: LaunchContext) -> None:
        """Restore the configurations."""
        context.scopes.pop_configurations()
