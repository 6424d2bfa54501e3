"""Stand-in for ``rclpy.action.graph``: which nodes have which actions."""

from typing import Any

from drake_twin.nodes.rclpy._rclpy_pybind11 import RCLError
from drake_twin.nodes.rclpy.node_graph import known_node

_Names = list[tuple[str, list[str]]]


def action_full_name(node: Any, name: Any, what: str) -> str:
    """Return an action's full name.

    Raises:
        ValueError: If ROS does not accept it.
    """
    try:
        full: str = node.resolve_service_name(name)
    except RCLError as error:
        raise ValueError(f"Failed to create action {what} due to invalid topic name '{name}' : {error}") from None
    return full


def get_action_client_names_and_types_by_node(node: Any, remote_node_name: str, remote_node_namespace: str) -> _Names:
    full = known_node(node.handle, remote_node_name, remote_node_namespace, "action client")
    found: _Names = node.handle.actions.names_of_clients(full)
    return found


def get_action_server_names_and_types_by_node(node: Any, remote_node_name: str, remote_node_namespace: str) -> _Names:
    full = known_node(node.handle, remote_node_name, remote_node_namespace, "action server")
    found: _Names = node.handle.actions.names_of_servers(full)
    return found


def get_action_names_and_types(node: Any) -> _Names:
    """Return each action with its types."""
    node.handle.check()
    found: _Names = node.handle.actions.names()
    return found
