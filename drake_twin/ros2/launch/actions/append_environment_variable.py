"""Appends to an environment variable."""

import os
from typing import Any

from drake_twin.ros2.launch.actions.set_environment_variable import SetEnvironmentVariable
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.typed_text import typed_text


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
