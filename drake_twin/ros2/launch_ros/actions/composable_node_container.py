"""Starts a container and loads nodes into it."""

from collections.abc import Iterable
from typing import Any

from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch_ros.actions.load_composable_nodes import LoadComposableNodes, parse_composable_nodes
from drake_twin.ros2.launch_ros.actions.node import Node


@expose_action("node_container")
class ComposableNodeContainer(Node):
    """Starts a container and loads nodes into it."""

    def __init__(
        self,
        *,
        name: SomeSubstitutionsType,
        namespace: SomeSubstitutionsType = "",
        composable_node_descriptions: Iterable[Any] | None = None,
        **kwargs: Any,
    ):
        super().__init__(name=name, namespace=namespace, **{"executable": "component_container", **kwargs})
        self.descriptions = list(composable_node_descriptions or ())

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<node_container>``."""
        _, arguments = super().parse(entity, parser)

        return cls, {**arguments, "composable_node_descriptions": parse_composable_nodes(entity, parser)}

    def execute(self, context: LaunchContext) -> Any:
        """Start the container, and load the nodes."""
        super().execute(context)
        load = LoadComposableNodes(composable_node_descriptions=self.descriptions, target_container=self)
        load.place = self.place
        return [load]
