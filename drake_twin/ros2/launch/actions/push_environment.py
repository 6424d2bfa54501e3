"""Saves the environment variables."""

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.expose import expose_action
from drake_twin.ros2.launch.launch_context import LaunchContext


@expose_action("push_environment")
class PushEnvironment(Action):
    """Saves the environment variables."""

    def execute(self, context: LaunchContext) -> None:
        """Save the variables."""
        context.scopes.push_environment()
