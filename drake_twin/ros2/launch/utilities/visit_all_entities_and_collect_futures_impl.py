"""ROS's name for `visit_all`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from drake_twin.ros2.visiting import visit_all

if TYPE_CHECKING:
    from drake_twin.ros2.launch.launch_context import LaunchContext


def visit_all_entities_and_collect_futures(entity: Any, context: LaunchContext) -> list[Any]:
    """Visit an entity and all that it leads to; return no futures, as evaluation is synchronous."""
    visit_all(entity, context)
    return []
