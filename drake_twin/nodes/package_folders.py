"""``ament_index_python`` for node programs: the folders of the workspace's packages.

``PackageFolders(folder_of).source`` returns its modules.
"""

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

from drake_twin.ros2.ament_index_python.packages import PackageNotFoundError
from drake_twin.ros2.packages import prefix_of


class PackageFolders:
    """The modules of ``ament_index_python``.

    Args:
        folder_of: Returns the share folder of a package, as it looks once installed; None without one.
    """

    def __init__(self, folder_of: Callable[[str], Path | None]):
        self._folder_of = folder_of
        self._known: dict[str, Path] = {}

    def source(self, name: str) -> ModuleType | None:
        """Return a new module; None if it is another one."""
        if name not in ("ament_index_python", "ament_index_python.packages"):
            return None
        module = ModuleType(name)
        functions = (
            self.get_package_share_directory,
            self.get_package_share_path,
            self.get_package_prefix,
            self.get_packages_with_prefixes,
        )
        vars(module).update({each.__name__: each for each in functions}, PackageNotFoundError=PackageNotFoundError)
        if name == "ament_index_python":
            module.__path__ = []
        return module

    def get_package_share_path(self, package_name: str, print_warning: bool = True) -> Path:
        """Return a package's share folder.

        Raises:
            PackageNotFoundError: If the package does not exist.
        """
        folder = self._folder_of(package_name)
        if folder is None:
            raise PackageNotFoundError(f"package '{package_name}' not found, searching: the workspace of the twin")
        self._known[package_name] = folder
        return folder

    def get_package_share_directory(self, package_name: str, print_warning: bool = True) -> str:
        """Return a package's share folder."""
        return str(self.get_package_share_path(package_name))

    def get_package_prefix(self, package_name: str) -> str:
        """Return the folder that holds a package's ``share/PACKAGE``."""
        return str(prefix_of(self.get_package_share_path(package_name)))

    def get_packages_with_prefixes(self) -> dict[str, str]:
        """Return the packages that were asked for and found, each with its prefix."""
        return {name: str(prefix_of(folder)) for name, folder in self._known.items()}
