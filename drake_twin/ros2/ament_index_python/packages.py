"""``ament_index_python`` for launch files: packages of the twin's index."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from drake_twin.ros2.evaluation import current_context


class PackageNotFoundError(KeyError):
    """A package that is not there; only launch files that name this exception ever see it."""


def get_package_share_directory(package_name: str, print_warning: bool = True) -> str:
    """A package's share folder; for an absent package, a path that says so when it is read."""
    _refuse_absent(package_name)
    return str(current_context().find_package(package_name))


def get_package_share_path(package_name: str, print_warning: bool = True) -> Path:
    """As `get_package_share_directory`, as a path."""
    _refuse_absent(package_name)
    return current_context().find_package(package_name)


def get_package_prefix(package_name: str) -> str:
    """The folder that holds a package's ``share/PACKAGE``."""
    _refuse_absent(package_name)
    context = current_context()
    return str(context.packages.prefix(package_name, context.current_launch_file))


def get_packages_with_prefixes() -> dict[str, str]:
    """The packages that were asked for so far; the index never lists them all."""
    context = current_context()
    names = context.packages.known_names()
    return {name: str(context.packages.prefix(name, context.current_launch_file)) for name in names}


def get_search_paths() -> list[str]:
    """The prefixes of installed workspaces."""
    return [path for path in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if path]


def get_resource(resource_type: str, resource_name: str, prefix: str | None = None) -> tuple[str, str]:
    """A package's entry in the index; its content is empty."""
    return "", get_package_prefix(resource_name)


def has_resource(resource_type: str, resource_name: str) -> str | bool:
    """The prefix of a package, or false."""
    context = current_context()
    if context.packages.present(resource_name, context.current_launch_file) is None:
        return False
    return get_package_prefix(resource_name)


def get_resources(resource_type: str) -> dict[str, str]:
    """See `get_packages_with_prefixes`."""
    return get_packages_with_prefixes()


def _refuse_absent(package: str) -> None:
    """Raises where the calling file is prepared for it: its code names PackageNotFoundError."""
    context = current_context()
    frame = sys._getframe(2)
    handles = PackageNotFoundError in frame.f_globals.values() or "PackageNotFoundError" in frame.f_code.co_names
    if handles and not context.packages.is_present(package, context.current_launch_file):
        raise PackageNotFoundError(f"package {package!r} is absent")
