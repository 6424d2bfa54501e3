"""What launch files give where ROS takes a text, as a list of substitutions."""

from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution
from drake_twin.ros2.launch.substitutions.text_substitution import TextSubstitution
from drake_twin.ros2.text_parts import text_parts


def normalize_to_list_of_substitutions(subs: SomeSubstitutionsType) -> list[Substitution]:
    """Return text, a path, a substitution or nested lists of them as a list of substitutions.

    Raises:
        TypeError: If it is something else.
    """
    return [TextSubstitution(text=part) if isinstance(part, str) else part for part in text_parts(subs)]
