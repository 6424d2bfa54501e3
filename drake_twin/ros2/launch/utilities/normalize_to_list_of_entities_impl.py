"""What launch files give where ROS takes entities, as a list."""

from collections.abc import Iterable
from typing import Any

from drake_twin.ros2.launch.launch_description_entity import LaunchDescriptionEntity


def normalize_to_list_of_entities(entities: Any) -> list[Any]:
    """Return one entity, or a list of them, nested or not, as a flat list."""
    if entities is None:
        return []
    if isinstance(entities, Iterable) and not isinstance(entities, str | LaunchDescriptionEntity):
        return [item for part in entities for item in normalize_to_list_of_entities(part)]
    return [entities]
