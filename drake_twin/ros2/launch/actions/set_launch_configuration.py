"""Sets a launch configuration."""

from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.text_parts import as_text


@expose_action("let")
class SetLaunchConfiguration(Action):
    """Sets a launch configuration."""

    def __init__(self, name: SomeSubstitutionsType, value: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.name = normalize_to_list_of_substitutions(name)
        self.value = normalize_to_list_of_substitutions(as_text(value))

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<let>``."""
        _, arguments = super().parse(entity, parser)

        return cls, {**arguments, **parser.parse_required(entity, "name", "value")}

    def execute(self, context: LaunchContext) -> None:
        """Set the configuration."""
        name, value = context.perform_substitution(self.name), context.perform_substitution(self.value)
        context.launch_configurations[name] = value
