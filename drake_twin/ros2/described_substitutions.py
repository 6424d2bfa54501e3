"""Substitutions in words."""

from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.substitutions.text_substitution import TextSubstitution
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions


def described(subst: SomeSubstitutionsType) -> str:
    """Return substitutions as ROS's ``describe`` writes the arguments of others: ``'a' + LaunchConfig('b')``."""
    return " + ".join(part.describe() for part in normalize_to_list_of_substitutions(subst))


def described_text(subst: SomeSubstitutionsType) -> str:
    """Return substitutions as ``ros2 launch --show-args`` prints them: text as it is, the others described."""
    parts = normalize_to_list_of_substitutions(subst)
    return "".join(part.text if isinstance(part, TextSubstitution) else part.describe() for part in parts)
