"""A condition that holds if a launch configuration has another value."""

from drake_twin.ros2.launch.conditions.launch_configuration_equals import LaunchConfigurationEquals
from drake_twin.ros2.launch.launch_context import LaunchContext


class LaunchConfigurationNotEquals(LaunchConfigurationEquals):
    """Holds if a launch configuration has another value."""

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether the configuration has another value."""
        return not super().evaluate(context)
