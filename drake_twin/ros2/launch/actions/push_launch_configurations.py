"""Saves the launch configurations."""

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.launch_context import LaunchContext


class PushLaunchConfigurations(Action):
    """Saves the launch configurations."""

    def execute(self, context: LaunchContext) -> None:
        """Save the configurations."""
        context.scopes.push_configurations()
