"""The types of what may stand for a text (``launch.some_substitutions_type``)."""

from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution

__all__ = ["SomeSubstitutionsType", "SomeSubstitutionsType_types_tuple"]

SomeSubstitutionsType_types_tuple = (str, Substitution, list, tuple)
