"""Loads nodes into a container."""

from collections.abc import Iterable
from typing import Any

from drake_twin.findings import Place
from drake_twin.ros2.launch.action import Action
from drake_twin.ros2.launch.actions.execute_local import performed
from drake_twin.ros2.launch.frontend.entity import Entity
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_action
from drake_twin.ros2.launch.frontend.parser import Parser
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch_ros.actions.node import Node
from drake_twin.ros2.launch_ros.descriptions.composable_node import ComposableNode
from drake_twin.ros2.launch_ros.utilities.evaluate_parameters import evaluate_parameters
from drake_twin.ros2.launched import COMPONENT, LaunchedProcess, absolute_name, joined_namespace
from drake_twin.ros2.node_settings import global_parameters, remapping_pairs


@expose_action("load_composable_node")
class LoadComposableNodes(Action):
    """Loads nodes into a container."""

    def __init__(self, *, composable_node_descriptions: Iterable[Any], target_container: Any, **kwargs: Any):
        super().__init__(**kwargs)
        self.descriptions = list(composable_node_descriptions)
        self.target_container = target_container

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> Parsed:
        """Return the class and its arguments for ``<load_composable_node>``."""
        _, arguments = super().parse(entity, parser)

        return cls, {
            **arguments,
            "composable_node_descriptions": parse_composable_nodes(entity, parser),
            "target_container": parser.parse_required(entity, "target")["target"],
        }

    def execute(self, context: LaunchContext) -> None:
        """Load the nodes."""
        base = context.launch_configurations.get("ros_namespace")
        target = self.target_container
        if isinstance(target, Node):
            container = target.node_name if target.started is not None else None
        else:
            container = absolute_name(context.perform_substitution(target), joined_namespace(base, None))
        for description in self.descriptions:
            if description.condition is not None and not description.condition.evaluate(context):
                continue
            context.start(
                LaunchedProcess(
                    kind=COMPONENT,
                    package=context.perform_substitution(description.package),
                    executable=context.perform_substitution(description.plugin),
                    name=performed(context, description.name),
                    namespace=joined_namespace(base, performed(context, description.namespace)),
                    parameters=(*global_parameters(context), *evaluate_parameters(context, description.parameters)),
                    remappings=tuple(remapping_pairs(context, description.remappings)),
                    place=self.place or Place(""),
                    container=container,
                )
            )


def parse_composable_nodes(entity: Entity, parser: Parser) -> list[ComposableNode]:
    """Return the composable nodes in an element."""
    nodes = []
    for child in entity.children_named("composable_node"):
        kind, arguments = ComposableNode.parse(child, parser)
        nodes.append(kind(**arguments))
    return nodes
