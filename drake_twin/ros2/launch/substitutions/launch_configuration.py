"""The value of a launch configuration."""

from collections.abc import Sequence
from typing import Any

from drake_twin.ros2.described_substitutions import described
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution, check_count
from drake_twin.ros2.launch.substitutions.substitution_failure import SubstitutionFailure
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.text_parts import as_texts


@expose_substitution("var")
class LaunchConfiguration(Substitution):
    """The value of a launch configuration, such as an argument.

    Args:
        variable_name: Its name.
        default: Its value where it is not set.
    """

    def __init__(self, variable_name: SomeSubstitutionsType, *, default: Any = None):
        self.variable_name = normalize_to_list_of_substitutions(variable_name)
        self.default = None if default is None else normalize_to_list_of_substitutions(as_texts(default))

    def perform(self, context: LaunchContext) -> str:
        """Return the value.

        Raises:
            SubstitutionFailure: If it is not set and has no default.
        """
        name = context.perform_substitution(self.variable_name)
        context.read.add(name)
        if name in context.launch_configurations:
            return str(context.launch_configurations[name])
        if self.default is not None:
            return context.perform_substitution(self.default)
        known = [key for key in context.launch_configurations if key not in ("ros_remaps", "global_params")]
        raise SubstitutionFailure(f"launch configuration {name!r} does not exist", value=name, valid=known)

    def describe(self) -> str:
        """Return ROS's own description."""
        return f"LaunchConfig({described(self.variable_name)})"


@expose_substitution("arg", jazzy=False)
def parse_arg(data: Sequence[SomeSubstitutionsType]) -> Parsed:
    """Return the class and its arguments for ``$(arg name)``, as ROS 1 spells it."""
    check_count(data, 1, 1)
    return LaunchConfiguration, {"variable_name": data[0]}
