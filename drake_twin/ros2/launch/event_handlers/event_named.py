"""A matcher of events by their name."""

from collections.abc import Callable
from typing import Any


def event_named(name: str) -> Callable[[Any], bool]:
    """Return a matcher of events by their name."""
    return lambda event: getattr(event, "name", None) == name
