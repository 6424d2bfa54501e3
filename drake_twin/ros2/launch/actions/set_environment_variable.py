"""Sets, extends and removes environment variables."""

import os
from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.typed_text import typed_text


@expose_action("set_env")
class SetEnvironmentVariable(Action):
    """Sets an environment variable."""

    _required = ("name", "value")

    def __init__(self, name: SomeSubstitutionsType, value: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.name = normalize_to_list_of_substitutions(name)
        self.value = normalize_to_list_of_substitutions(value)

    def execute(self, context: LaunchContext) -> None:
        """Set the variable."""
        context.environment[context.perform_substitution(self.name)] = context.perform_substitution(self.value)


@expose_action("append_env")
class AppendEnvironmentVariable(SetEnvironmentVariable):
    """Appends to an environment variable, or prepends."""

    def __init__(
        self,
        name: SomeSubstitutionsType,
        value: SomeSubstitutionsType,
        prepend: Any = False,
        separator: SomeSubstitutionsType = os.pathsep,
        **kwargs: Any,
    ):
        super().__init__(name, value, **kwargs)
        self.prepend = prepend
        self.separator = separator

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<append_env>``."""
        _, arguments = super().parse(entity, parser)

        prepend = parser.parse_if_substitutions(entity.get_attr("prepend", data_type=bool, optional=True) or False)
        if isinstance(prepend, str):
            entity.refused_by_ros(f"prepend is the text {prepend!r}, and not of type bool")
        return cls, {**arguments, "prepend": prepend, **parser.parse_optional(entity, "separator")}

    def execute(self, context: LaunchContext) -> None:
        """Append or prepend."""
        name, value = context.perform_substitution(self.name), context.perform_substitution(self.value)
        if context.environment.get(name):
            prepend = self.prepend
            if not isinstance(prepend, bool):
                prepend = typed_text(context.perform_substitution(prepend), bool).value
            parts = [value, context.environment[name]] if prepend else [context.environment[name], value]
            value = context.perform_substitution(self.separator).join(parts)
        context.environment[name] = value


@expose_action("unset_env")
class UnsetEnvironmentVariable(Action):
    """Removes an environment variable."""

    _required = ("name",)

    def __init__(self, name: SomeSubstitutionsType, **kwargs: Any):
        super().__init__(**kwargs)
        self.name = normalize_to_list_of_substitutions(name)

    def execute(self, context: LaunchContext) -> None:
        """Remove the variable."""
        context.environment.pop(context.perform_substitution(self.name), None)
