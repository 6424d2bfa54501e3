"""A node that is loaded into a container."""

from collections.abc import Iterable
from typing import Any

from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.node_elements import parse_parameters, parse_remappings

__all__ = ["ComposableLifecycleNode", "ComposableNode"]


class ComposableNode:
    """A node that is loaded into a container."""

    def __init__(
        self,
        *,
        package: SomeSubstitutionsType,
        plugin: SomeSubstitutionsType,
        name: SomeSubstitutionsType | None = None,
        namespace: SomeSubstitutionsType | None = None,
        parameters: Any = None,
        remappings: Iterable[Any] | None = None,
        extra_arguments: Any = None,
        condition: Any = None,
    ):
        self.package, self.plugin, self.name, self.namespace = package, plugin, name, namespace
        self.parameters, self.remappings = parameters, list(remappings or ())
        self.extra_arguments, self.condition = extra_arguments, condition

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<composable_node>``."""
        _, arguments = Action.parse(entity, parser)
        return cls, {
            **arguments,
            **parser.parse_optional(entity, "name", "namespace"),
            "package": parser.parse_required(entity, "pkg")["pkg"],
            "plugin": parser.parse_required(entity, "plugin")["plugin"],
            "parameters": parse_parameters(entity, parser),
            "remappings": parse_remappings(entity, parser),
        }

    @property
    def node_plugin(self) -> Any:
        """The plugin."""
        return self.plugin

    @property
    def node_name(self) -> Any:
        """The name."""
        return self.name


ComposableLifecycleNode = ComposableNode
