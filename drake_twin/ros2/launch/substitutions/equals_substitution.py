"""Whether two texts are equal, or differ."""

import math
from typing import Any

from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import Substitution
from drake_twin.ros2.launch.substitutions.boolean_substitution import text_of
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.text_parts import as_texts

_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}  # fewer than those of $(not …)


@expose_substitution("equals")
class EqualsSubstitution(Substitution):
    """``true`` if two texts, numbers or truth values are equal."""

    def __init__(self, left: Any, right: Any):
        self.left = normalize_to_list_of_substitutions(as_texts(left))
        self.right = normalize_to_list_of_substitutions(as_texts(right))

    def perform(self, context: LaunchContext) -> str:
        """Return ``true`` or ``false``."""
        return text_of(self.equal(context))

    def equal(self, context: LaunchContext) -> bool:
        """Return whether the texts are equal."""
        left, right = context.perform_substitution(self.left), context.perform_substitution(self.right)
        booleans = [_BOOLEANS.get(text.lower()) for text in (left, right)]
        if None not in booleans:
            return booleans[0] == booleans[1]
        try:
            return math.isclose(float(left), float(right))
        except ValueError:
            return left == right


@expose_substitution("not-equals")
class NotEqualsSubstitution(EqualsSubstitution):
    """``true`` if two texts, numbers or truth values differ."""

    def perform(self, context: LaunchContext) -> str:
        """Return ``true`` or ``false``."""
        return text_of(not self.equal(context))
