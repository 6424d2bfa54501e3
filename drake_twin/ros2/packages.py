"""Packages as launch files see them: found, built in, or absent."""

import contextlib
import functools
import os
import re
from pathlib import Path

from drake_twin.description.lasting_files import lasting_folder
from drake_twin.description.package_index import PackageIndex, containing_package
from drake_twin.errors import InputError

# The folders of packages that only ROS has: a path below them can be passed on, and reading from it names the package.
ABSENT = "/package-not-found"
BUILT_IN = "/built-in"
_ABSENT_PATH = re.compile(rf"{ABSENT}/([^/'\"\s:,]+)")


class AbsentError(InputError):
    """Raised for what this machine does not have: a package, a file of it, a Python module."""


class LaunchPackages(PackageIndex):
    """A package index that answers for every package and remembers which ones are absent.

    Args:
        packages: Where packages are searched.
        built_in: Packages that the twin stands in for, which are never searched.
    """

    def __init__(self, packages: PackageIndex, built_in: frozenset[str] = frozenset()):
        self._packages = packages
        self._built_in = built_in
        self._known: dict[tuple[str, Path | None], tuple[Path | None, str]] = {}
        self._workspaces: list[Path] = []
        self.absent: dict[str, str] = {}  # name → where it was searched

    @property
    def folders(self) -> tuple[Path, ...]:
        """The folders that are searched first, and those of Gazebo's and ROS 1's path variables."""
        return (*self._packages.folders, *self._packages.resource_folders)

    def find(self, package: str, near: str | Path | None = None) -> Path:
        """Return the share folder of a package; for an absent one, a path that cannot exist and holds its name."""
        if package in self._built_in:
            return Path(BUILT_IN, package)
        found = self.present(package, near)
        return Path(ABSENT, package) if found is None else found

    def present(self, package: str, near: str | Path | None = None) -> Path | None:
        """Return the share folder of a package that exists; note another as absent and return None."""
        folder, looked_in = self._looked_up(package, near)
        if folder is None:
            self.absent.setdefault(package, looked_in)
        return folder

    def is_present(self, package: str, near: str | Path | None = None) -> bool:
        """Return whether a package exists or is built in, without noting it as absent."""
        return package in self._built_in or self._looked_up(package, near)[0] is not None

    def known_names(self) -> list[str]:
        """Return the packages that were asked for and found."""
        return list(dict.fromkeys(name for (name, _), (folder, _) in self._known.items() if folder is not None))

    def resolve(self, address: str, base: str | Path | None = None) -> Path:
        """Resolve an address, see `PackageIndex.resolve`."""
        return self._packages.resolve(address, base)

    def prefix(self, package: str, near: str | Path | None = None) -> Path:
        """Return the folder that holds ``share/PACKAGE``, as in an install tree."""
        share = self.find(package, near)
        return share if str(share.parent) in (ABSENT, BUILT_IN) else prefix_of(share)

    def locate(self, path: str | Path, near: str | Path | None = None) -> Path:
        """Find a file that is named by its author's own path, by the package in the path.

        Args:
            path: A path such as ``/home/me/ws/src/PACKAGE/urdf/x.xacro``; one that exists is returned as it is.
            near: A file of the workspace to search first.
        """
        path = Path(path)
        if not path.is_absolute() or path.exists() or str(path).startswith((ABSENT, BUILT_IN)):
            return path
        parts = path.parts
        for index in range(1, len(parts) - 1):
            if not parts[index].isidentifier():
                continue
            # A folder's name does not ask for a package, so an absent one is not noted.
            folder = self.present(parts[index], near) if self.is_present(parts[index], near) else None
            if folder is not None and folder.joinpath(*parts[index + 1 :]).exists():
                return folder.joinpath(*parts[index + 1 :])
        return path

    def _looked_up(self, package: str, near: str | Path | None) -> tuple[Path | None, str]:
        """Return the folder, and where it was searched if it is None."""
        workspace = None if near is None else containing_package(Path(near).resolve())
        key = (package, workspace)
        if key not in self._known:
            self._known[key] = self._look_for(package, workspace)
        if workspace is not None and workspace not in self._workspaces:
            self._workspaces.append(workspace)
        return self._known[key]

    def _look_for(self, package: str, workspace: Path | None) -> tuple[Path | None, str]:
        reason = ""
        for place in dict.fromkeys([workspace, *self._workspaces]):
            near = None if place is None else place / "package.xml"
            try:
                return self._packages.find(package, near), ""
            except InputError as error:
                reason = reason or str(error)
        for repository in dict.fromkeys(_repository(place) for place in [workspace, *self._workspaces] if place):
            if repository is not None:
                with contextlib.suppress(InputError):
                    return PackageIndex([repository], environment={}).find(package), ""
        return None, reason


def absent_package_in(text: str) -> str | None:
    """Return the absent package whose placeholder a text holds; None if it holds none."""
    match = _ABSENT_PATH.search(text)
    return None if match is None else match[1]


def _repository(package: Path) -> Path | None:
    """Return the checkout that a package is part of: its packages may stand in several folders."""
    return next((folder for folder in package.parents if (folder / ".git").exists()), None)


@functools.lru_cache(maxsize=1024)
def prefix_of(share: Path) -> Path:
    """Return the folder that holds ``share/PACKAGE``, for a package's share folder; that of a source has a link."""
    if share.parent.name == "share":
        return share.parent.parent
    prefix = lasting_folder(str(share)) / "prefix"
    link = prefix / "share" / share.name
    link.parent.mkdir(parents=True, exist_ok=True)
    if not os.path.lexists(link):
        with contextlib.suppress(FileExistsError):  # another process was faster
            link.symlink_to(share)
    return prefix
