"""``ament_index_python`` for node programs: the folders of the workspace's packages.

``PackageFolders(folder_of).source`` returns its modules.
"""

import typing
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

from drake_twin.ros2.ament_index_python.packages import PackageNotFoundError
from drake_twin.ros2.ament_index_python.resource_index import (
    RESOURCE_INDEX_SUBFOLDER,
    InvalidResourceNameError,
    InvalidResourceTypeNameError,
    ResourceIndex,
    get_search_paths,
)
from drake_twin.ros2.packages import prefix_of

_PACKAGES = "get_package_prefix get_package_share_directory get_package_share_path get_packages_with_prefixes"
_BOTH = "get_resource get_resources get_search_paths"
_OTHERS = (
    "InvalidResourceNameError InvalidResourceTypeNameError RESOURCE_INDEX_SUBFOLDER get_resource_types has_resource"
)
# Module → its names; the package has them all.
_MODULES: dict[str, list[str]] = {
    "ament_index_python": [],
    "ament_index_python.packages": f"{_PACKAGES} {_BOTH} PackageNotFoundError".split(),
    "ament_index_python.resources": f"{_BOTH} {_OTHERS}".split(),
}
_TYPING = {
    "ament_index_python.packages": ("Dict",),
    "ament_index_python.resources": ("Dict", "Literal", "Tuple", "Union"),
}


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
        if name not in _MODULES:
            return None
        index = ResourceIndex(self._prefix, self.get_packages_with_prefixes)
        known: tuple[Any, ...] = (
            *(self.get_package_share_directory, self.get_package_share_path, self.get_package_prefix),
            *(self.get_packages_with_prefixes, PackageNotFoundError),
            *(index.get_resource, index.get_resources, index.get_resource_types, index.has_resource),
            *(get_search_paths, InvalidResourceNameError, InvalidResourceTypeNameError),
        )
        members = {each.__name__: each for each in known} | {"RESOURCE_INDEX_SUBFOLDER": RESOURCE_INDEX_SUBFOLDER}
        module = ModuleType(name)
        if name == "ament_index_python":
            module.__path__ = []
            vars(module)["__all__"] = list(members)
        vars(module).update({key: members[key] for key in _MODULES[name] or members})
        vars(module).update({key: getattr(typing, key) for key in _TYPING.get(name, ())})
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

    def _prefix(self, package: str) -> str | None:
        return None if self._folder_of(package) is None else self.get_package_prefix(package)

    def get_packages_with_prefixes(self) -> dict[str, str]:
        """Return the packages that were asked for and found, each with its prefix."""
        return {name: str(prefix_of(folder)) for name, folder in self._known.items()}
