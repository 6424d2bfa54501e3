"""Matchers of actions."""

from collections.abc import Callable
from typing import Any


def matches_action(target_action: Any) -> Callable[[Any], bool]:
    """Return a matcher of one action."""
    return lambda action: action is target_action
