"""The value of a parameter of all nodes."""

from typing import Any

import yaml

from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution
from drake_twin.ros2.launch.substitutions.substitution_failure import SubstitutionFailure
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.text_parts import as_texts


@expose_substitution("param")
class Parameter(Substitution):
    """The value of a parameter that SetParameter gave to all nodes.

    Args:
        name: Its name.
        default: The value where no SetParameter gives one.
    """

    def __init__(self, name: SomeSubstitutionsType, *, default: Any = None):
        self.name = normalize_to_list_of_substitutions(name)
        self.default = None if default is None else normalize_to_list_of_substitutions(as_texts(default))

    def perform(self, context: LaunchContext) -> str:
        """Return the value.

        Raises:
            SubstitutionFailure: If no SetParameter gives one and it has no default.
        """
        name = context.perform_substitution(self.name)
        for item in reversed(context.launch_configurations.get("global_params", [])):
            if isinstance(item, tuple) and item[0] == name:
                return yaml.safe_dump(item[1]).split("\n")[0] if not isinstance(item[1], str) else item[1]
        if self.default is not None:
            return context.perform_substitution(self.default)
        raise SubstitutionFailure(f"no SetParameter gives a value to {name!r}")
