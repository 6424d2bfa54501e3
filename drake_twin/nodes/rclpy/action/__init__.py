"""Stand-in for ``rclpy.action``."""

from typing import Any

from drake_twin.nodes.rclpy.action.client import ActionClient
from drake_twin.nodes.rclpy.action.server import ActionServer, CancelResponse, GoalResponse

__all__ = ["ActionClient", "ActionServer", "CancelResponse", "GoalResponse", "get_action_names_and_types"]


def get_action_names_and_types(node: Any) -> list[tuple[str, list[str]]]:
    """Return each action with its types."""
    found: list[tuple[str, list[str]]] = node.actions.names()
    return found
