"""A condition that holds if its text says false."""

from drake_twin.ros2.launch.conditions.if_condition import IfCondition
from drake_twin.ros2.launch.launch_context import LaunchContext


class UnlessCondition(IfCondition):
    """Holds if its text says false (or 0)."""

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether the text says false."""
        return not super().evaluate(context)
