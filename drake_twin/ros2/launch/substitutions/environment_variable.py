"""The value of an environment variable."""

from collections.abc import Sequence

from drake_twin.ros2.described_substitutions import described
from drake_twin.ros2.launch.frontend.expose import Parsed, expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import MANY, SomeSubstitutionsType, Substitution, check_count
from drake_twin.ros2.launch.substitutions.substitution_failure import SubstitutionFailure
from drake_twin.ros2.launch.substitutions.text_substitution import joined_words
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions


@expose_substitution("env")
class EnvironmentVariable(Substitution):
    """An environment variable's value.

    Args:
        name: Its name.
        default_value: Its value where it is not set.
    """

    def __init__(self, name: SomeSubstitutionsType, *, default_value: SomeSubstitutionsType | None = None):
        self.name = normalize_to_list_of_substitutions(name)
        self.default_value = None if default_value is None else normalize_to_list_of_substitutions(default_value)

    def perform(self, context: LaunchContext) -> str:
        """Return the value, or the default.

        Raises:
            SubstitutionFailure: If it is not set and has no default.
        """
        name = context.perform_substitution(self.name)
        value = context.environment.get(name)
        if value is not None:
            return value
        if self.default_value is None:
            raise SubstitutionFailure(f"environment variable {name!r} is not set")
        return context.perform_substitution(self.default_value)

    def describe(self) -> str:
        """Return ROS's own description."""
        return f"EnvVar({described(self.name)})"


@expose_substitution("optenv", jazzy=False)
def parse_optenv(data: Sequence[SomeSubstitutionsType]) -> Parsed:
    """Return the class and its arguments for ``$(optenv name words of the default)``."""
    check_count(data, 1, MANY)
    return EnvironmentVariable, {"name": data[0], "default_value": joined_words(data[1:])}
