"""ROS's name for `visit_all`."""

from typing import Any

from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.visiting import visit_all


def visit_all_entities_and_collect_futures(entity: Any, context: LaunchContext) -> list[Any]:
    """Visit an entity and all that it leads to; return no futures, as evaluation is synchronous."""
    visit_all(entity, context)
    return []
