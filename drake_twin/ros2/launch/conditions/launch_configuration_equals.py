"""Conditions that hold if a launch configuration has a value, or another one."""

from drake_twin.ros2.launch.condition import Condition
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType


class LaunchConfigurationEquals(Condition):
    """Holds if a launch configuration has a value; with None, if it is not set."""

    def __init__(self, launch_configuration_name: str, expected_value: SomeSubstitutionsType | None):
        super().__init__()
        self._name = launch_configuration_name
        self._expected = expected_value

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether the configuration has the value."""
        value = context.launch_configurations.get(self._name)
        expected = None if self._expected is None else context.perform_substitution(self._expected)
        return bool(value == expected)


class LaunchConfigurationNotEquals(LaunchConfigurationEquals):
    """Holds if a launch configuration has another value."""

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether the configuration has another value."""
        return not super().evaluate(context)
