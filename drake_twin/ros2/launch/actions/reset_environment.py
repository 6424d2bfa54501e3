"""Restores the environment that the launch was started with."""

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.expose import expose_action
from drake_twin.ros2.launch.launch_context import LaunchContext


@expose_action("reset_env")
class ResetEnvironment(Action):
    """Restores the environment that the launch was started with."""

    def execute(self, context: LaunchContext) -> None:
        """Restore the variables."""
        context.scopes.reset_environment()
