"""The folders of ROS packages, and the files that ``package://``, ``model://`` and ``file://`` addresses name."""

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

from drake_twin.description.share_layout import installed_layout, package_name
from drake_twin.errors import InputError

# Folders without source packages, or with copies of them.
_SKIPPED_FOLDERS = {"build", "log", "node_modules", "site-packages", "__pycache__"}
_SEARCH_DEPTH = 6
_LONGEST_NAME = 255  # bytes, of a folder on most disks

_PREFIX_VARIABLES = ("AMENT_PREFIX_PATH", "COLCON_PREFIX_PATH")
_FOLDER_VARIABLES = ("ROS_PACKAGE_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH")


_ADVICE = "Name the folder that holds it with --package-path, or in AMENT_PREFIX_PATH or ROS_PACKAGE_PATH"


class MissingPackageError(InputError):
    """Raised for a package that was not found.

    Args:
        package: The package's name.
        searched: The folders that were searched.
        advice: What brings it there.
    """

    def __init__(self, package: str, searched: Iterable[str], advice: str = _ADVICE):
        self.package = package
        self.searched = ", ".join(searched)
        self.advice = advice
        super().__init__(f"package {package!r} was not found in: {self.searched}. {self.advice}")


class PackageIndex:
    """Finds packages by name, the closest source first.

    These are searched in order, until one has the package: the folders given, the workspace of the file at hand (its
    package's neighbours), the packages installed under ``AMENT_PREFIX_PATH`` and ``COLCON_PREFIX_PATH``, the folders of
    ``ROS_PACKAGE_PATH``, ``GZ_SIM_RESOURCE_PATH``, ``IGN_GAZEBO_RESOURCE_PATH`` and ``GAZEBO_MODEL_PATH``, and the
    twin's own models.

    Args:
        folders: Folders of packages (or packages themselves) to search first.
        environment: The environment variables; the process's own by default.

    Attributes:
        resource_folders: The folders of Gazebo's and ROS 1's path variables, in order.

    Raises:
        InputError: If one of the folders does not exist.
    """

    def __init__(self, folders: Iterable[str | Path] = (), environment: Mapping[str, str] | None = None):
        environment = os.environ if environment is None else environment
        self._folders = tuple(Path(absolute_path(folder)) for folder in folders)
        for folder in self._folders:
            if not folder.is_dir():
                raise InputError("the package folder does not exist", file=folder)
        self._prefixes = _folders_of(environment, _PREFIX_VARIABLES)
        self.resource_folders = _folders_of(environment, _FOLDER_VARIABLES)

    @property
    def folders(self) -> tuple[Path, ...]:
        """The folders that are searched first."""
        return self._folders

    def packages(self) -> Iterator[Path]:
        """Yield the packages of all folders that are searched, the closest first."""
        shares = (prefix / "share" for prefix in self._prefixes)
        for folder in (*self._folders, *shares, *self.resource_folders, share_folder("models")):
            yield from packages_in(folder)

    def packages_near(self, files: Iterable[Path]) -> Iterator[Path]:
        """Yield the packages of the workspaces that some files are in, and of all folders that are searched."""
        for file in files:
            own = containing_package(file)
            for workspace in [] if own is None else workspaces_of(own):
                yield from packages_in(workspace)
        yield from self.packages()

    def find(self, package: str, near: str | Path | None = None) -> Path:
        """Find the share folder of a package; that of a source package looks as if it were installed.

        Args:
            package: The package's name.
            near: A file of the workspace to search first.

        Raises:
            MissingPackageError: If the package is not found; the text lists the folders that were searched.
        """
        if len(os.fsencode(package)) > _LONGEST_NAME:
            raise MissingPackageError(f"{package[:80]}…", ["any folder: the name is too long"])
        for folder in self._candidates(package, near):
            if folder.is_dir():
                return installed_layout(folder)
        searched = [str(folder) for folder in self._source_folders(near)]
        searched += [f"{prefix}/share" for prefix in self._prefixes]
        raise MissingPackageError(package, searched)

    def resolve(self, address: str, base: str | Path | None = None) -> Path:
        """Find the file that an address names.

        Args:
            address: ``package://``, ``model://``, ``file://``, or a path relative to ``base``.
            base: The file that holds the address.

        Raises:
            InputError: If the package or the file does not exist.
        """
        scheme, separator, rest = address.partition("://")
        if not separator:
            scheme, rest = "file", address
        if scheme in ("package", "model"):
            package, _, inside = rest.partition("/")
            path = self.find(package, base) / inside
        elif scheme == "file":
            path = Path(absolute_path(rest))
            if base is not None and not Path(rest).is_absolute() and not rest.startswith("~"):
                path = Path(base).absolute().parent / rest
        else:
            raise InputError(f"unknown scheme of {address!r}", valid=["package://", "model://", "file://"])
        try:
            exists = path.exists()
        except OSError as error:  # a name that is too long, say
            raise InputError(f"this is not a file's name ({error.strerror})", file=path) from None
        if not exists:
            raise InputError("the file does not exist", file=path)
        return Path(os.path.abspath(path))

    def resolve_elsewhere(self, address: str, base: str | Path | None = None) -> Path:
        """Find a file whose address is of another machine: in the package that one of its folders is named after.

        The innermost such folder counts: ``/home/author/ws/src/rover/meshes/wheel.stl`` is ``meshes/wheel.stl`` of the
        package ``rover``.

        Raises:
            InputError: If no package has it.
        """
        parts = Path(address.partition("://")[2] or address).parts
        for index in range(len(parts) - 2, -1, -1):
            try:
                return self.resolve(f"package://{'/'.join(parts[index:])}".replace(":////", "://"), base)
            except InputError:
                continue
        raise InputError("no package has this file", file=address)

    def resolve_as_started(self, address: str, base: str | Path | None = None) -> Path:
        """Find a file whose relative path the robot's file means from where the simulator is started.

        This may be beside the file, in a workspace with the package ``my_robot`` of ``./my_robot/config/file.yaml``
        (below ``src``, ``install`` or ``share``, too), or in the working directory. An absolute path of another machine
        is found by `resolve_elsewhere`.

        Raises:
            InputError: As `resolve`.
        """
        try:
            return self.resolve(address, base)
        except InputError:
            if "://" in address:
                raise
            if Path(address).is_absolute():
                with suppress(InputError):
                    return self.resolve_elsewhere(address, base)
                raise
            inside = Path(address).parts
            for index, name in enumerate(inside[:-1]):
                if name in (".", "..", "src", "install", "share"):
                    continue
                try:
                    package = self.find(name, base)
                except InputError:
                    continue
                if (file := package.joinpath(*inside[index + 1 :])).is_file():
                    return file
            if Path(address).is_file():
                return Path(os.path.abspath(address))
            raise

    def _candidates(self, package: str, near: str | Path | None) -> Iterator[Path]:
        for folder in self._folders:
            yield from _in_folder(folder, package)
        if near is not None:
            own_package = containing_package(near)
            if own_package is not None:
                if _is_named(own_package, package):
                    yield own_package
                if own_package.parent.name == "share":
                    yield from _in_prefix(own_package.parents[1], package)
                    yield from _in_prefix(own_package.parents[2], package)
                for workspace in workspaces_of(own_package):
                    yield from _in_folder(workspace, package)
        for prefix in self._prefixes:
            yield from _in_prefix(prefix, package)
        for folder in self.resource_folders:
            yield from _in_folder(folder, package)
        yield from _in_folder(share_folder("models"), package)

    def _source_folders(self, near: str | Path | None) -> list[Path]:
        own_package = None if near is None else containing_package(near)
        workspaces = [] if own_package is None else workspaces_of(own_package)
        return [*self._folders, *workspaces, *self.resource_folders, share_folder("models")]


def _folders_of(environment: Mapping[str, str], variables: Iterable[str]) -> tuple[Path, ...]:
    paths = (environment.get(variable, "").split(os.pathsep) for variable in variables)
    return tuple(Path(folder) for folders in paths for folder in folders if folder)


def absolute_path(name: str | Path) -> str:
    """Return a path that a user typed as an absolute one; it may begin with ``~``."""
    try:
        return os.path.abspath(Path(name).expanduser())
    except RuntimeError:  # the home of an unknown user
        return os.path.abspath(name)


def share_folder(name: str) -> Path:
    """Return the twin's own ``models`` or ``diagrams``: of an installed wheel, or at the top of the source tree."""
    package = Path(__file__).resolve().parent.parent
    installed = package / "share" / name
    return installed if installed.is_dir() else package.parent / name


def containing_package(file: str | Path) -> Path | None:
    """Return the innermost folder above a file that holds a ``package.xml``."""
    for folder in Path(file).absolute().parents:
        if (folder / "package.xml").is_file():
            return folder
    return None


def workspace_folders(workspace: str | Path) -> tuple[Path, ...]:
    """List the folders of packages of a colcon workspace for `PackageIndex`: its sources, then its install folders.

    Args:
        workspace: The workspace, its ``src`` or ``install`` folder, or a folder of packages.

    Raises:
        InputError: If the folder does not exist, or holds no package.
    """
    root = Path(absolute_path(workspace))
    if not root.is_dir():
        raise InputError("the workspace does not exist", file=root)
    installed = [*_share_folders(root / "install"), *_share_folders(root)]
    source = root / "src" if (root / "src").is_dir() else root
    has_sources = (source / "package.xml").is_file() or (not installed and _packages_below(source))
    has_sources = has_sources or (source != root and _packages_below(source))
    folders = ([source] if has_sources else []) + installed
    if not folders:
        raise InputError(
            "the workspace holds no ROS package: it has neither a package.xml nor an install folder", file=root
        )
    return tuple(folders)


def surrounding_workspace(folder: Path) -> Path | None:
    """Return the colcon workspace that a folder is in: it holds ``src`` with packages, or ``install``."""
    for place in (folder, *list(folder.parents)[:_SEARCH_DEPTH]):
        installed = place / "install"
        if _packages_below(place / "src") or (installed / "setup.sh").is_file() or _share_folders(installed):
            return place
    return None


def _share_folders(install: Path) -> list[Path]:
    """List the share folders of an install tree: one where it is merged, one a package where it is isolated."""
    merged = install / "share"
    found = [merged] if merged.is_dir() and any(merged.glob("*/package.xml")) else []
    return found + sorted(path.parents[1] for path in install.glob("*/share/*/package.xml"))


def _in_prefix(prefix: Path, package: str) -> Iterator[Path]:
    """Yield places for an installed package: in a merged install tree, then in an isolated one."""
    yield prefix / "share" / package
    yield prefix / package / "share" / package


def _in_folder(folder: Path, package: str) -> Iterator[Path]:
    """Yield places for a package at or below a folder: by the name in its package.xml, then by the folder's name."""
    named = folder / package
    ignored = (named / "COLCON_IGNORE").exists()
    for place in (folder,) if ignored else (named, folder):
        if (place / "package.xml").is_file() and _is_named(place, package):
            yield place
    yield from (place for place in _packages_below(folder) if _is_named(place, package))
    if named.is_dir() and not ignored:  # a Gazebo model folder, or a package without its package.xml
        yield named


def _is_named(place: Path, package: str) -> bool:
    """Return whether a package has a name: that in its package.xml, or that under which setup.py registers it."""
    return package_name(place) == package or (place / "resource" / package).is_file()


def workspace_of(package: Path) -> Path:
    """Return the folder whose packages a package sees: its colcon workspace's ``src``, or its parent folder."""
    return workspaces_of(package)[0]


def workspaces_of(package: Path) -> list[Path]:
    """Return that folder, and those around it: a repository with a ``src`` may be in the ``src`` of a workspace."""
    return [folder for folder in list(package.parents)[:_SEARCH_DEPTH] if folder.name == "src"] or [package.parent]


@lru_cache(maxsize=256)
def _packages_below(folder: Path, depth: int = _SEARCH_DEPTH) -> tuple[Path, ...]:
    """List the folders with a package.xml, as colcon finds them.

    Packages inside another package, and folders with COLCON_IGNORE, are left out.
    """
    found: list[Path] = []
    try:
        names = sorted(entry.name for entry in os.scandir(folder) if entry.is_dir())
    except OSError:
        return ()
    for name in names:
        place = folder / name
        if name.startswith(".") or name in _SKIPPED_FOLDERS or (place / "COLCON_IGNORE").exists():
            continue
        if (place / "package.xml").is_file():
            found.append(place)
        elif depth > 1:
            found.extend(_packages_below(place, depth - 1))
    return tuple(found)


def packages_in(folder: Path) -> tuple[Path, ...]:
    """Return the packages at or below a folder."""
    return (folder,) if (folder / "package.xml").is_file() else _packages_below(folder)
