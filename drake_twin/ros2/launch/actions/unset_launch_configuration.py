"""Removes a launch configuration."""

from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions


class UnsetLaunchConfiguration(Action):
    """Removes a launch configuration."""

    def __init__(self, name: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.name = normalize_to_list_of_substitutions(name)

    def execute(self, context: LaunchContext) -> None:
        """Remove the configuration."""
        context.launch_configurations.pop(context.perform_substitution(self.name), None)
