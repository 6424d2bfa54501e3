"""The path of an executable that a package installs."""

from pathlib import Path

from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions
from drake_twin.ros2.launch_ros.substitutions.find_package import FindPackagePrefix


@expose_substitution("exec-in-pkg")
class ExecutableInPackage(FindPackagePrefix):
    """The path of an executable that a package installs; it need not exist here."""

    def __init__(self, executable: SomeSubstitutionsType, package: SomeSubstitutionsType):
        super().__init__(package)
        self.executable = normalize_to_list_of_substitutions(executable)

    def folder(self, context: LaunchContext, name: str) -> str:
        """Return the executable of a package."""
        executable = context.perform_substitution(self.executable)
        return str(Path(super().folder(context, name), "lib", name, executable))
