"""Removes all launch configurations but those given."""

from collections.abc import Mapping
from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext


@expose_action("reset")
class ResetLaunchConfigurations(Action):
    """Removes all launch configurations but those given."""

    def __init__(self, launch_configurations: Mapping[Any, Any] | None = None, **kwargs: Any):
        super().__init__(**kwargs)
        self.launch_configurations = dict(launch_configurations or {})

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<reset>``."""
        _, arguments = super().parse(entity, parser)
        return cls, {**arguments, "launch_configurations": kept_configurations(entity, parser)}

    def execute(self, context: LaunchContext) -> None:
        """Replace the configurations."""
        context.scopes.replace_configurations(
            {
                context.perform_substitution(name): context.perform_substitution(value)
                for name, value in self.launch_configurations.items()
            }
        )


def kept_configurations(entity: Entity, parser: Parser) -> dict[Any, Any]:
    """Return names and values of the ``<keep>`` elements of ``<group>`` and ``<reset>``, as substitutions."""
    return {tuple(pair["name"]): pair["value"] for pair in parser.parse_children(entity, "keep", "name", "value")}
