"""``ament_index_python`` for node programs: the folders of the workspace's packages.

``PackageFolders(folder_of).source`` returns its modules.
"""

from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

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
        if name not in ("ament_index_python", "ament_index_python.packages", "ament_index_python.resources"):
            return None
        module = ModuleType(name)
        functions: list[Callable[..., Any]] = [self.get_resource, self.get_resources, self.has_resource]
        if name != "ament_index_python.resources":
            functions += [self.get_package_share_directory, self.get_package_share_path]
            functions += [self.get_package_prefix, self.get_packages_with_prefixes]
            vars(module)["PackageNotFoundError"] = PackageNotFoundError
        vars(module).update({each.__name__: each for each in functions})
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

    def has_resource(self, resource_type: str, resource_name: str) -> str | bool:
        """Return the prefix of a package that is there, or of one that is installed with a resource; else false."""
        folder = self._folder_of(resource_name)
        if folder is None:
            return False
        prefix = prefix_of(folder)
        return str(prefix) if resource_type == "packages" or _entry(prefix, resource_type, resource_name) else False

    def get_resource(self, resource_type: str, resource_name: str) -> tuple[str, str]:
        """Return the content of a resource, and its prefix.

        Raises:
            LookupError: If it does not exist.
        """
        prefix = self.has_resource(resource_type, resource_name)
        if isinstance(prefix, bool):
            raise LookupError(f"Could not find the resource '{resource_name}' of type '{resource_type}'")
        entry = _entry(Path(prefix), resource_type, resource_name)
        return entry.read_text(encoding="utf-8") if entry else "", prefix

    def get_resources(self, resource_type: str) -> dict[str, str]:
        """Return the packages that were asked for, found and have a resource, each with its prefix."""
        found = ((name, self.has_resource(resource_type, name)) for name in self._known)
        return {name: prefix for name, prefix in found if isinstance(prefix, str)}


def _entry(prefix: Path, kind: str, name: str) -> Path | None:
    """Return the file of a resource; None without one, as where a package is not installed."""
    file = prefix / "share" / "ament_index" / "resource_index" / kind / name
    return file if file.is_file() else None
