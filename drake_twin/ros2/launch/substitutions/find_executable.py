"""The path of an executable."""

import shutil
from pathlib import Path

from drake_twin.ros2.described_substitutions import described
from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.scratch_folder import scratch_folder


@expose_substitution("find-exec")
class FindExecutable(Substitution):
    """The path of an executable; its name where the twin stands in for it (``ros2``, ``gz``) or it is not found."""

    def __init__(self, *, name: SomeSubstitutionsType):
        self.name = normalize_to_list_of_substitutions(name)

    def perform(self, context: LaunchContext) -> str:
        """Return the path."""
        name = context.perform_substitution(self.name)
        found = shutil.which(name, path=context.environment.get("PATH"))
        return name if found is None or Path(found).is_relative_to(scratch_folder()) else found

    def describe(self) -> str:
        """Return ROS's own description."""
        return f"FindExec({described(self.name)})"
