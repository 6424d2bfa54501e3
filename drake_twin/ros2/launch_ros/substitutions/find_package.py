"""The folders of a package."""

from drake_twin.ros2.described_substitutions import described
from drake_twin.ros2.evaluation import current_context
from drake_twin.ros2.launch.frontend.expose import expose_substitution
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType, Substitution
from drake_twin.ros2.launch.utilities.normalize_to_list_of_substitutions_impl import normalize_to_list_of_substitutions


class FindPackage(Substitution):
    """A package's folder; subclasses define which one."""

    def __init__(self, package: SomeSubstitutionsType):
        self.package = normalize_to_list_of_substitutions(package)

    def perform(self, context: LaunchContext) -> str:
        """Return the folder."""
        return self.folder(context, context.perform_substitution(self.package))

    def find(self, package_name: str) -> str:
        """Return the folder of a package, seen from the file at hand."""
        return self.folder(current_context(), package_name)

    def folder(self, context: LaunchContext, name: str) -> str:
        """Return the share folder of a package."""
        return str(context.packages.find(name, context.current_launch_file))

    def describe(self) -> str:
        """Return ROS's own description."""
        return f"{type(self).__name__.replace('Package', 'Pkg')}(pkg={described(self.package)})"


@expose_substitution("find-pkg-share")
@expose_substitution("find", jazzy=False)
class FindPackageShare(FindPackage):
    """A package's share folder."""


@expose_substitution("find-pkg-prefix")
class FindPackagePrefix(FindPackage):
    """The folder that holds ``share/PACKAGE``."""

    def folder(self, context: LaunchContext, name: str) -> str:
        """Return the prefix of a package."""
        return str(context.packages.prefix(name, context.current_launch_file))
