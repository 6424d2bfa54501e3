"""What a node is on the graph."""

from collections.abc import Callable
from typing import Any

from drake_twin.nodes.action_graph import ActionGraph
from drake_twin.nodes.graph import Graph
from drake_twin.nodes.rclpy.handle import Handle
from drake_twin.nodes.rclpy.names import expanded_name
from drake_twin.nodes.task import present_task
from drake_twin.ros2.launched import remapped


class NodeHandle(Handle):
    """What a node is on the graph, apart from the attributes that a user's subclass may take for itself.

    Args:
        base: The node's own name.
        namespace: Its namespace.
        context: Its context.
        arguments: Its command line.

    Attributes:
        base: The node's own name.
        namespace: Its namespace.
        context: Its context.
        arguments: Its command line.
        program: The program that it belongs to.
        graph: The topics and services of the graph.
        actions: Its actions.
        entities: What an executor looks at, in this order.
        executor: The node's executor; None without one.
        add_waitable: Adds a waitable to the node.
    """

    def __init__(self, base: str, namespace: str, context: Any, arguments: Any):
        name = f"{namespace.rstrip('/')}/{base}"
        super().__init__(lambda: self.graph.remove_node(name), name, name.strip("/").replace("/", "."))
        self.base, self.namespace, self.context, self.arguments = base, namespace, context, arguments
        self.program = present_task().program
        self.graph: Graph = self.program.rclpy["graph"]
        self.actions: ActionGraph = self.program.rclpy["actions"]
        self.entities: list[Any] = []
        self.executor: Any = None
        self.add_waitable: Callable[[Any], None] = self.entities.append

    def expanded(self, name: str) -> str:
        """Return the full name of a topic or service.

        Raises:
            RCLError: If ROS does not accept it.
        """
        return expanded_name(name, self.namespace, self.base)

    def remapped(self, full: str) -> str:
        """Return what the command line has for the full name of a topic or service."""
        return remapped(full, self.namespace, self.name, self.arguments.remappings)

    def add(self, item: Any, order: Callable[[Any], int]) -> None:
        """Add what an executor looks at."""
        self.entities.append(item)
        self.entities.sort(key=order)
        if self.executor is not None:
            self.executor.wake()

    def remove(self, item: Any) -> None:
        """Remove it again, if it is there."""
        if item in self.entities:
            self.entities.remove(item)
