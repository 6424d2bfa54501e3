"""Whether a parameter file has an entry for a node."""

from drake_twin.description.bounded_yaml import load_yaml
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.rewritten_files import source_of


class HasNodeParams(Substitution):
    """``True`` if a parameter file has an entry for a node."""

    def __init__(self, source_file: SomeSubstitutionsType, node_name: str):
        self.source_file = normalize_to_list_of_substitutions(source_file)
        self.node_name = node_name

    def perform(self, context: LaunchContext) -> str:
        """Return ``True`` or ``False``."""
        data = load_yaml(source_of(context, self.source_file).text)
        return str(isinstance(data, dict) and self.node_name in data)
