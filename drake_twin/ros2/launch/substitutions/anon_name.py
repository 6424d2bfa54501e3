"""A unique name."""

from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions


@expose_substitution("anon")
class AnonName(Substitution):
    """A unique name; the same in every run."""

    def __init__(self, name: SomeSubstitutionsType):
        self.name = normalize_to_list_of_substitutions(name)

    def perform(self, context: LaunchContext) -> str:
        """Return the name."""
        return context.anonymous_name(context.perform_substitution(self.name))
