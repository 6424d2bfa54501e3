"""A source package as it looks once installed: ``$(find pkg)/urdf`` may be the folder ``description/urdf`` of the
source.

CMakeLists.txt, setup.py and setup.cfg are read, not run. The installed look is a folder of links in the cache, which is
made only for packages whose two layouts differ.
"""

import contextlib
import hashlib
import os
import tempfile
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

from lxml import etree

from drake_twin.description.cmake_install import cmake_installs
from drake_twin.description.mesh_cache import cache_folder
from drake_twin.description.setup_py import setup_installs

# Folders that packages usually install to the top of their share folder.
_USUAL_FOLDERS = {"config", "gazebo", "launch", "maps", "meshes", "models", "params", "ros2_control", "rviz"}
_USUAL_FOLDERS |= {"sdf", "srdf", "urdf", "worlds", "xacro"}


@lru_cache(maxsize=1024)
def installed_layout(package: Path) -> Path:
    """Return the folder of a package as its share folder would look; the package itself where that is the same.

    Files of the source are never hidden by installed ones.

    Args:
        package: The folder with the package.xml, of a source or an installed package.
    """
    package = Path(os.path.abspath(package))
    if package.parent.name == "share":
        return package
    moved = [(place, source) for place, source in _installs(package) if _adds(package / place, source)]
    if not moved:
        return package
    views = cache_folder("share")
    with tempfile.TemporaryDirectory(dir=views) as folder:
        view = Path(folder) / package.name
        view.mkdir()
        for entry in package.iterdir():
            (view / entry.name).symlink_to(entry)
        for place, source in moved:
            _lay(view, view / place, source)
        # The same path in every run for the same look, so that a scenario that names a file in it can be saved.
        lasting = views / _digest(view) / package.name
        if not lasting.is_dir():
            lasting.parent.mkdir(exist_ok=True)
            with contextlib.suppress(OSError):  # another process was faster
                view.rename(lasting)
    return lasting


@lru_cache(maxsize=4096)
def package_name(folder: Path) -> str:
    """Return the ``<name>`` in a folder's ``package.xml``, or the folder's own name."""
    try:
        return (etree.parse(folder / "package.xml").findtext("name") or folder.name).strip()
    except (etree.XMLSyntaxError, OSError):
        return folder.name


def _digest(view: Path) -> str:
    """Return a short digest of the links in a folder."""
    digest = hashlib.sha256()
    for folder, folders, files in os.walk(view):
        folders.sort()
        for name in sorted([*folders, *files]):
            path = Path(folder, name)
            target = os.readlink(path) if path.is_symlink() else ""
            digest.update(f"{path.relative_to(view)}\0{target}\n".encode(errors="replace"))
    return digest.hexdigest()[:16]


def _installs(package: Path) -> Iterator[tuple[str, Path]]:
    """Yield place in the share folder, and the source that is installed there."""
    name = package_name(package)
    if (package / "CMakeLists.txt").is_file():
        yield from cmake_installs(package, name)
    if (package / "setup.py").is_file() or (package / "setup.cfg").is_file():
        yield from setup_installs(package, name)
    elif not (package / "CMakeLists.txt").is_file():
        # Without build files (a collection of data files, say) the usual folders go to the top.
        for outer in sorted(path for path in package.iterdir() if path.is_dir() and path.name not in _USUAL_FOLDERS):
            for inner in sorted(path for path in outer.iterdir() if path.is_dir() and path.name in _USUAL_FOLDERS):
                yield inner.name, inner


def _adds(place: Path, source: Path) -> bool:
    """Tell whether a source adds anything to a place that the source package lacks."""
    if place.is_dir() and source.is_dir() and not place.samefile(source):
        return any(_adds(place / entry.name, entry) for entry in source.iterdir())
    return not place.exists()


def _lay(view: Path, place: Path, source: Path) -> None:
    """Link a source to a place, beside what exists there."""
    for folder in reversed([parent for parent in place.parents if parent.is_relative_to(view) and parent != view]):
        _unfold(folder)
        if not folder.is_dir():
            if os.path.lexists(folder):
                return  # a file stands where a folder would be
            folder.mkdir()
    if not os.path.lexists(place):
        place.symlink_to(source)
    elif place.is_dir() and source.is_dir():
        _unfold(place)
        for entry in sorted(source.iterdir()):
            _lay(view, place / entry.name, entry)


def _unfold(folder: Path) -> None:
    """Replace a link to a folder by a folder of links, so that more can be added to it."""
    if folder.is_symlink() and folder.is_dir():
        target = folder.resolve()
        folder.unlink()
        folder.mkdir()
        for entry in target.iterdir():
            (folder / entry.name).symlink_to(entry)
