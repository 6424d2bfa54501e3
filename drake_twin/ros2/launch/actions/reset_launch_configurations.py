"""Removes all launch configurations but those given."""

from collections.abc import Mapping
from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.expose import expose_action
from drake_twin.ros2.launch.launch_context import LaunchContext


@expose_action("reset")
class ResetLaunchConfigurations(Action):
    """Removes all launch configurations but those given."""

    def __init__(self, launch_configurations: Mapping[Any, Any] | None = None, **kwargs: Any):
        super().__init__(**kwargs)
        self.launch_configurations = dict(launch_configurations or {})

    def execute(self, context: LaunchContext) -> None:
        """Replace the configurations."""
        context.scopes.replace_configurations(
            {
                context.perform_substitution(name): context.perform_substitution(value)
                for name, value in self.launch_configurations.items()
            }
        )
