"""Texts, joined with a delimiter."""

from collections.abc import Iterable, Sequence
from typing import Any

from drake_twin.ros2.launch.frontend.expose import Parsed, expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import MANY, SomeSubstitutionsType, Substitution, check_count
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions


@expose_substitution("string-join", jazzy=False)
class StringJoinSubstitution(Substitution):
    """Texts, joined with a delimiter."""

    def __init__(self, substitutions: Iterable[Any], delimiter: SomeSubstitutionsType = ""):
        self.substitutions = [normalize_to_list_of_substitutions(part) for part in substitutions]
        self.delimiter = normalize_to_list_of_substitutions(delimiter)

    def perform(self, context: LaunchContext) -> str:
        """Return the joined text."""
        parts = [context.perform_substitution(part) for part in self.substitutions]
        return context.perform_substitution(self.delimiter).join(parts)

    @classmethod
    def parse(cls, data: Sequence[SomeSubstitutionsType]) -> Parsed:
        """Return the class and its arguments for ``$(string-join delimiter text text …)``."""
        check_count(data, 1, MANY)
        return cls, {"substitutions": data[1:], "delimiter": data[0]}
