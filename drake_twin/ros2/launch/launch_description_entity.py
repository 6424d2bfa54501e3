"""Entities: what a launch description consists of."""

from collections.abc import Iterable
from typing import Any

from drake_twin.findings import Place
from drake_twin.ros2.launch.launch_context import LaunchContext


class LaunchDescriptionEntity:
    """Anything that a launch description may hold.

    Attributes:
        place: Where it was written.
    """

    place: Place | None = None

    def visit(self, context: LaunchContext) -> Iterable[Any] | None:
        """Do what the entity is for; return the entities to visit next."""
        return None

    def describe_sub_entities(self) -> list[Any]:
        """Return the entities that it always visits."""
        return []

    def describe_conditional_sub_entities(self) -> list[tuple[str, list[Any]]]:
        """Return the entities that it may visit, each list with the condition in words."""
        return []

    def describe(self) -> str:
        """Return the entity in a few words."""
        return f"{type(self).__name__}"

    def get_asyncio_future(self) -> None:
        """Return None: evaluation is synchronous."""
