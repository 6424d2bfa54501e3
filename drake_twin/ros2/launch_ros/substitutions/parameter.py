"""The value of a parameter of all nodes."""

import yaml

from drake_twin.errors import InputError
from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions


@expose_substitution("param")
class Parameter(Substitution):
    """The value of a parameter that SetParameter gave to all nodes."""

    def __init__(self, name: SomeSubstitutionsType):
        self.name = normalize_to_list_of_substitutions(name)

    def perform(self, context: LaunchContext) -> str:
        """Return the value.

        Raises:
            InputError: If no SetParameter gives one.
        """
        name = context.perform_substitution(self.name)
        for item in reversed(context.launch_configurations.get("global_params", [])):
            if isinstance(item, tuple) and item[0] == name:
                return yaml.safe_dump(item[1]).split("\n")[0] if not isinstance(item[1], str) else item[1]
        raise InputError(f"no SetParameter gives a value to {name!r}")
