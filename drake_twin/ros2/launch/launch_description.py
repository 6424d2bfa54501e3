"""Launch descriptions: lists of entities that are visited in turn."""

from collections.abc import Iterable
from typing import Any

from drake_twin.ros2.launch.actions.declare_launch_argument import DeclareLaunchArgument
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.launch_description_entity import LaunchDescriptionEntity
from drake_twin.ros2.places import place_of_caller
from drake_twin.ros2.visiting import every_entity


class LaunchDescription(LaunchDescriptionEntity):
    """A list of entities that are visited in turn.

    Args:
        initial_entities: The entities.
        deprecated_reason: Why the file should not be used any more; ignored.
    """

    def __init__(self, initial_entities: Iterable[Any] | None = None, *, deprecated_reason: str | None = None):
        self._entities = list(initial_entities or ())
        self._deprecated_reason = deprecated_reason
        self.place = place_of_caller()

    @property
    def entities(self) -> list[Any]:
        """The entities."""
        return self._entities

    @property
    def deprecated(self) -> bool:
        """Whether the file should not be used any more."""
        return self._deprecated_reason is not None

    @property
    def deprecated_reason(self) -> str | None:
        """Why the file should not be used any more."""
        return self._deprecated_reason

    def add_entity(self, entity: Any) -> None:
        """Add an entity at the end."""
        self._entities.append(entity)

    def add_action(self, action: Any) -> None:
        """Add an action at the end."""
        self.add_entity(action)

    def visit(self, context: LaunchContext) -> list[Any]:
        """Return the entities."""
        return self._entities

    def describe_sub_entities(self) -> list[Any]:
        """Return the entities."""
        return self._entities

    def get_launch_arguments(self, conditional_inclusion: bool = False) -> list[Any]:
        """Return the DeclareLaunchArgument actions of the description itself and of its groups."""
        entities = every_entity(self, conditional=conditional_inclusion)
        return [entity for entity in entities if isinstance(entity, DeclareLaunchArgument)]
