"""Saves and restores the environment variables and the launch configurations."""

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.expose import expose_action
from drake_twin.ros2.launch.launch_context import LaunchContext


@expose_action("push_environment")
class PushEnvironment(Action):
    """Saves the environment variables."""

    def execute(self, context: LaunchContext) -> None:
        """Save the variables."""
        context.scopes.push_environment()


@expose_action("pop_environment")
class PopEnvironment(Action):
    """Restores the environment variables that were saved last."""

    def execute(self, context: LaunchContext) -> None:
        """Restore the variables."""
        context.scopes.pop_environment()


@expose_action("reset_env")
class ResetEnvironment(Action):
    """Restores the environment that the launch was started with."""

    def execute(self, context: LaunchContext) -> None:
        """Restore the variables."""
        context.scopes.reset_environment()


class PushLaunchConfigurations(Action):
    """Saves the launch configurations."""

    def execute(self, context: LaunchContext) -> None:
        """Save the configurations."""
        context.scopes.push_configurations()


class PopLaunchConfigurations(Action):
    """Restores the launch configurations that were saved last."""

    def execute(self, context: LaunchContext) -> None:
        """Restore the configurations."""
        context.scopes.pop_configurations()
