"""Sets and removes launch configurations."""

from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.expose import expose_action
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.text_parts import as_text


@expose_action("let")
class SetLaunchConfiguration(Action):
    """Sets a launch configuration."""

    _required = ("name", "value")

    def __init__(self, name: SomeSubstitutionsType, value: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.name = normalize_to_list_of_substitutions(name)
        self.value = normalize_to_list_of_substitutions(as_text(value))

    def execute(self, context: LaunchContext) -> None:
        """Set the configuration."""
        name, value = context.perform_substitution(self.name), context.perform_substitution(self.value)
        context.launch_configurations[name] = value


class UnsetLaunchConfiguration(Action):
    """Removes a launch configuration."""

    def __init__(self, name: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.name = normalize_to_list_of_substitutions(name)

    def execute(self, context: LaunchContext) -> None:
        """Remove the configuration."""
        context.launch_configurations.pop(context.perform_substitution(self.name), None)
