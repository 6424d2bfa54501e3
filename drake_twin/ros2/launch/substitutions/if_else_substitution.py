"""One of two texts."""

from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution
from drake_twin.ros2.launch.substitutions.boolean_substitution import evaluate_boolean
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.text_parts import as_texts


@expose_substitution("if")
class IfElseSubstitution(Substitution):
    """One of two texts, by a condition."""

    def __init__(
        self,
        condition: SomeSubstitutionsType,
        if_value: SomeSubstitutionsType = "",
        else_value: SomeSubstitutionsType = "",
    ):
        self.condition = normalize_to_list_of_substitutions(as_texts(condition))
        self.if_value = normalize_to_list_of_substitutions(as_texts(if_value))
        self.else_value = normalize_to_list_of_substitutions(as_texts(else_value))

    def perform(self, context: LaunchContext) -> str:
        """Return the text."""
        value = self.if_value if evaluate_boolean(context, self.condition) else self.else_value
        return context.perform_substitution(value)
