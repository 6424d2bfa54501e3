"""Restores the environment variables that were saved last."""

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.expose import expose_action
from drake_twin.ros2.launch.launch_context import LaunchContext


@expose_action("pop_environment")
class PopEnvironment(Action):
    """Restores the environment variables that were saved last."""

    def execute(self, context: LaunchContext) -> None:
        """Restore the variables."""
        context.scopes.pop_environment()
