"""The variables of ForEach and the index of ForLoop."""

from collections.abc import Sequence

from drake_twin.ros2.launch.frontend.expose import Parsed, expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution, check_count
from drake_twin.ros2.launch.substitutions.substitution_failure import SubstitutionFailure
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions


@expose_substitution("for-var")
class ForEachVar(Substitution):
    """The value of a ForEach's variable."""

    def __init__(self, name: SomeSubstitutionsType, default_value: SomeSubstitutionsType | None = None):
        self.name = normalize_to_list_of_substitutions(name)
        self.default_value = default_value

    def perform(self, context: LaunchContext) -> str:
        """Return the value.

        Raises:
            SubstitutionFailure: If the loop has no such variable, and the substitution no default.
        """
        name = context.perform_substitution(self.name)
        values = context.get_locals_as_dict().get("for_each", {})
        if name in values:
            return str(values[name])
        if self.default_value is None:
            raise SubstitutionFailure(f"the loop has no variable {name!r}", value=name, valid=values)
        return context.perform_substitution(self.default_value)


@expose_substitution("index")
class ForLoopIndex(ForEachVar):
    """The index of a ForLoop."""

    @classmethod
    def parse(cls, data: Sequence[SomeSubstitutionsType]) -> Parsed:
        """Return the class and its arguments for ``$(index name)``."""
        check_count(data, 1, 1)
        return cls, {"name": data[0]}
