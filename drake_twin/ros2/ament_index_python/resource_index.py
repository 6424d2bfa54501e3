"""The resources of ROS's index of packages: those of a twin's workspace, and those of installed workspaces."""

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Literal

from drake_twin.description.source_file import file_text

RESOURCE_INDEX_SUBFOLDER = "share/ament_index/resource_index"
_PACKAGES = "packages"


class InvalidResourceTypeNameError(ValueError):
    """Raised for a type of resources whose name holds a separator of paths."""


class InvalidResourceNameError(ValueError):
    """Raised for a resource whose name holds a separator of paths."""


def get_search_paths() -> list[str]:
    """Return the prefixes of installed workspaces: none where ROS is not sourced, as a twin needs none."""
    paths = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return [path for path in paths if path and os.path.exists(path)]


class ResourceIndex:
    """The functions of ``ament_index_python.resources``.

    A package of the workspace is a resource of the type ``packages``, whether it is installed or a source.

    Args:
        prefix: Returns the prefix of a package; None if it does not exist.
        packages: Returns the packages of the workspace that are known, each with its prefix.
    """

    def __init__(self, prefix: Callable[[str], str | None], packages: Callable[[], Mapping[str, str]]):
        self._prefix = prefix
        self._packages = packages

    def get_resource(self, resource_type: str, resource_name: str) -> tuple[str, str]:
        """Return the content of a resource and its prefix.

        Raises:
            LookupError: If it does not exist.
            InvalidResourceTypeNameError: If the type's name holds a separator of paths.
            InvalidResourceNameError: If its name does.
        """
        found = self.has_resource(resource_type, resource_name)
        if not found:
            raise LookupError(f"Could not find the resource '{resource_name}' of type '{resource_type}'")
        file = Path(found, RESOURCE_INDEX_SUBFOLDER, resource_type, resource_name)
        return file_text(file) if file.is_file() else "", found

    def has_resource(self, resource_type: str, resource_name: str) -> str | Literal[False]:
        """Return the prefix of a resource, or False; raises as `get_resource` for wrong names."""
        _check(resource_type)
        assert resource_name, "The resource name must not be empty"
        if _has_separator(resource_name):
            raise InvalidResourceNameError(f"Resource name '{resource_name}' is invalid")
        own = self._prefix(resource_name)
        if resource_type == _PACKAGES and own is not None:
            return own
        for path in ([] if own is None else [own]) + get_search_paths():
            if Path(path, RESOURCE_INDEX_SUBFOLDER, resource_type, resource_name).is_file():
                return path
        return False

    def get_resources(self, resource_type: str) -> dict[str, str]:
        """Return the resources of a type, each with its prefix; of the workspace, the packages that are known."""
        _check(resource_type)
        found = dict(self._packages()) if resource_type == _PACKAGES else {}
        for path in dict.fromkeys((*self._packages().values(), *get_search_paths())):
            for file in _listed(Path(path, RESOURCE_INDEX_SUBFOLDER, resource_type)):
                if not file.is_dir():
                    found.setdefault(file.name, path)
        return found

    def get_resource_types(self) -> set[str]:
        """Return the types of resources."""
        folders = (folder for path in get_search_paths() for folder in _listed(Path(path, RESOURCE_INDEX_SUBFOLDER)))
        return {_PACKAGES} | {folder.name for folder in folders if folder.is_dir()}


def _listed(folder: Path) -> list[Path]:
    return [item for item in folder.iterdir() if not item.name.startswith(".")] if folder.is_dir() else []


def _check(resource_type: str) -> None:
    assert resource_type, "The resource type must not be empty"
    if _has_separator(resource_type):
        raise InvalidResourceTypeNameError(f"Resource type '{resource_type}' is invalid")


def _has_separator(name: str) -> bool:
    return "/" in name or "\\" in name
