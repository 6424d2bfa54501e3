"""Matchers of nodes."""

from collections.abc import Callable
from typing import Any


def matches_node_name(node_name: str) -> Callable[[Any], bool]:
    """Return a matcher of a node's full name."""
    return lambda action: getattr(action, "node_name", None) == "/" + node_name.lstrip("/")
