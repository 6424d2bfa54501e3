"""Packages as launch files see them: found, built in, or absent and named once."""

import atexit
import contextlib
import functools
import hashlib
import os
import re
import shutil
import tempfile
from pathlib import Path

from drake_twin.description.mesh_cache import cache_folder
from drake_twin.description.package_index import PackageIndex, containing_package
from drake_twin.errors import InputError

# Packages that only ROS has: a path below these can be passed on, and reading from it says what is missing.
ABSENT = "/package-not-found"
BUILT_IN = "/built-in"
_ABSENT_PATH = re.compile(rf"{ABSENT}/([^/'\"\s:,]+)")


class AbsentError(InputError):
    """Something that this machine does not have: a package, a file of it, a Python module."""


class LaunchPackages(PackageIndex):
    """A package index that answers for every package and remembers which ones are absent.

    Args:
        packages: where packages are looked for.
        built_in: packages that the twin stands in for, which are never looked for.
    """

    def __init__(self, packages: PackageIndex, built_in: frozenset[str] = frozenset()):
        self._packages = packages
        self._built_in = built_in
        self._known: dict[tuple[str, Path | None], tuple[Path | None, str]] = {}
        self._workspaces: list[Path] = []
        self.absent: dict[str, str] = {}  # name → where it was looked for

    @property
    def folders(self) -> tuple[Path, ...]:
        """The folders that are looked in first, and those of Gazebo's and ROS 1's path variables."""
        return (*self._packages.folders, *self._packages.resource_folders)

    def find(self, package: str, near: str | Path | None = None) -> Path:
        """The share folder of a package, or a path that cannot exist and tells whose it is."""
        if package in self._built_in:
            return Path(BUILT_IN, package)
        found = self.present(package, near)
        return Path(ABSENT, package) if found is None else found

    def present(self, package: str, near: str | Path | None = None) -> Path | None:
        """The share folder of a package that is really there; one that is not is noted as absent."""
        folder, looked_in = self._looked_up(package, near)
        if folder is None:
            self.absent.setdefault(package, looked_in)
        return folder

    def is_present(self, package: str, near: str | Path | None = None) -> bool:
        """Whether a package is there or built in; asking does not make it an absent one."""
        return package in self._built_in or self._looked_up(package, near)[0] is not None

    def known_names(self) -> list[str]:
        """The packages that were asked for and found."""
        return list(dict.fromkeys(name for (name, _), (folder, _) in self._known.items() if folder is not None))

    def resolve(self, address: str, base: str | Path | None = None) -> Path:
        """As `PackageIndex.resolve`."""
        return self._packages.resolve(address, base)

    def prefix(self, package: str, near: str | Path | None = None) -> Path:
        """The folder that holds ``share/PACKAGE``, as in an install tree."""
        share = self.find(package, near)
        if share.parent.name == "share":
            return share.parent.parent
        if str(share.parent) in (ABSENT, BUILT_IN):
            return share
        return _prefix_of(share)

    def locate(self, path: str | Path, near: str | Path | None = None) -> Path:
        """A file that a launch file names by its author's own path, found by the package in it.

        Args:
            path: a path such as ``/home/someone/ws/src/PACKAGE/urdf/x.xacro``; one that exists is returned as it is.
            near: a file of the workspace to look in first.
        """
        path = Path(path)
        if not path.is_absolute() or path.exists() or str(path).startswith((ABSENT, BUILT_IN)):
            return path
        parts = path.parts
        for index in range(1, len(parts) - 1):
            if not parts[index].isidentifier():
                continue
            # A folder's name is no request for a package.
            folder = self.present(parts[index], near) if self.is_present(parts[index], near) else None
            if folder is not None and folder.joinpath(*parts[index + 1 :]).exists():
                return folder.joinpath(*parts[index + 1 :])
        return path

    def _looked_up(self, package: str, near: str | Path | None) -> tuple[Path | None, str]:
        """The folder, or why there is none."""
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
    """The absent package whose placeholder a text names, if it names one."""
    match = _ABSENT_PATH.search(text)
    return None if match is None else match[1]


def _repository(package: Path) -> Path | None:
    """The checkout that a package is part of: its packages may stand in several folders."""
    return next((folder for folder in package.parents if (folder / ".git").exists()), None)


@functools.lru_cache(maxsize=1024)
def _prefix_of(share: Path) -> Path:
    prefix = lasting_folder(str(share)) / "prefix"
    link = prefix / "share" / share.name
    link.parent.mkdir(parents=True, exist_ok=True)
    if not os.path.lexists(link):
        with contextlib.suppress(FileExistsError):  # another process was faster
            link.symlink_to(share)
    return prefix


def lasting_folder(content: str) -> Path:
    """A folder for files made on the way, in the user's cache: the same path in every run for the same content."""
    folder = cache_folder("launch") / hashlib.sha256(content.encode()).hexdigest()[:16]
    folder.mkdir(exist_ok=True)
    return folder


@functools.lru_cache(maxsize=1)
def scratch_folder() -> Path:
    """A folder of this process, removed when it ends."""
    folder = Path(tempfile.mkdtemp(prefix="drake_twin_launch_"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder
