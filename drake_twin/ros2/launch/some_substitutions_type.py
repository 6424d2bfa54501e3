"""The types of what may stand for a text: text, a substitution, or a list of them (``launch.some_substitutions_type``)."""

from typing import Any

from drake_twin.ros2.substitution import Substitution

__all__ = ["SomeSubstitutionsType", "SomeSubstitutionsType_types_tuple"]

SomeSubstitutionsType = Any
SomeSubstitutionsType_types_tuple = (str, Substitution, list, tuple)
