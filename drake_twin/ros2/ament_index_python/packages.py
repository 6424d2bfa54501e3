"""``ament_index_python.packages`` for launch files: packages of the twin's index."""

import sys
from pathlib import Path

from drake_twin.ros2.evaluation import current_context


class PackageNotFoundError(KeyError):
    """Raised for an absent package, where the launch file names this exception."""


def get_package_share_directory(package_name: str, print_warning: bool = True) -> str:
    """Return a package's share folder; for an absent package, a path whose reading is refused with its name."""
    _refuse_absent(package_name)
    return str(_share(package_name))


def get_package_share_path(package_name: str, print_warning: bool = True) -> Path:
    """Return a package's share folder, as `get_package_share_directory`."""
    _refuse_absent(package_name)
    return _share(package_name)


def get_package_prefix(package_name: str) -> str:
    """Return the folder that holds a package's ``share/PACKAGE``."""
    _refuse_absent(package_name)
    context = current_context()
    return str(context.packages.prefix(package_name, context.current_launch_file))


def get_packages_with_prefixes() -> dict[str, str]:
    """Return the packages that were asked for so far; the index never lists them all."""
    context = current_context()
    names = context.packages.known_names()
    return {name: str(context.packages.prefix(name, context.current_launch_file)) for name in names}


def _share(package: str) -> Path:
    context = current_context()
    return context.packages.find(package, context.current_launch_file)


def _refuse_absent(package: str) -> None:
    """Raise PackageNotFoundError where the calling file is prepared for it: its code names the exception."""
    context = current_context()
    frame = sys._getframe(2)
    handles = PackageNotFoundError in frame.f_globals.values() or "PackageNotFoundError" in frame.f_code.co_names
    if handles and not context.packages.is_present(package, context.current_launch_file):
        raise PackageNotFoundError(f"package {package!r} is absent")
