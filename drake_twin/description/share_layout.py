"""A source package as it looks once installed: ``$(find pkg)/urdf`` may be the folder ``description/urdf`` of the
source.

CMakeLists.txt, setup.py and setup.cfg are read, not run. The installed look is a folder in the cache, which is made
only for packages whose two layouts differ. Its folders are folders and its files are links, as by
``colcon build --symlink-install``: ``Path.rglob`` does not enter links to folders.
"""

import contextlib
import hashlib
import os
import tempfile
from collections.abc import Iterable, Iterator
from functools import lru_cache
from pathlib import Path

from lxml import etree

from drake_twin.description.cmake_install import cmake_installs
from drake_twin.description.mesh_cache import in_cache
from drake_twin.description.source_file import file_bytes

# Folders that packages usually install to the top of their share folder.
_USUAL_FOLDERS = {"config", "gazebo", "launch", "maps", "meshes", "models", "params", "ros2_control", "rviz"}
_USUAL_FOLDERS |= {"sdf", "srdf", "urdf", "worlds", "xacro"}
_BUILT = ("build", "install", "log", "node_modules", "__pycache__")

_Tree = dict[str, "Path | _Tree"]


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
    tree = _tree_of(package)
    for place, source in moved:
        _lay(tree, Path(os.path.normpath(place)).parts, source)
    entries = sorted(_entries(tree, ""))
    return in_cache("share", lambda folder: _view(folder, package.name, entries))


def _view(folder: Path, name: str, entries: list[tuple[str, Path | None]]) -> Path:
    # The same path in every run for the same look, so that a scenario that names a file in it can be saved.
    lasting = folder / _digest(entries) / name
    if not lasting.is_dir():
        lasting.parent.mkdir(exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            view = Path(scratch) / name
            view.mkdir()
            for entry, target in entries:
                if target is None:
                    (view / entry).mkdir()
                else:
                    (view / entry).symlink_to(target)
            with contextlib.suppress(OSError):  # another process was faster
                view.rename(lasting)
    return lasting


@lru_cache(maxsize=4096)
def package_name(folder: Path) -> str:
    """Return the ``<name>`` in a folder's ``package.xml``, or the folder's own name."""
    try:
        return (etree.fromstring(file_bytes(folder / "package.xml")).findtext("name") or folder.name).strip()
    except (etree.XMLSyntaxError, OSError):
        return folder.name


def _digest(entries: Iterable[tuple[str, Path | None]]) -> str:
    """Return a short digest of folders and links."""
    digest = hashlib.sha256()
    for name, target in entries:
        digest.update(f"{name}\0{target or ''}\n".encode(errors="replace"))
    return digest.hexdigest()[:16]


def _installs(package: Path) -> Iterator[tuple[str, Path]]:
    """Yield place in the share folder, and the source that is installed there."""
    name = package_name(package)
    if (package / "CMakeLists.txt").is_file():
        yield from cmake_installs(package, name)
    if (package / "setup.py").is_file() or (package / "setup.cfg").is_file():
        from drake_twin.description.setup_py import setup_installs

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


def _tree_of(folder: Path) -> _Tree:
    """Return a folder's files, and its folders with theirs, but for hidden and built ones: those are links."""
    tree: _Tree = {}
    for entry in os.scandir(folder):
        path = Path(entry.path)
        is_open = entry.is_dir(follow_symlinks=False) and not entry.name.startswith(".") and entry.name not in _BUILT
        tree[entry.name] = _tree_of(path) if is_open else path
    return tree


def _lay(tree: _Tree, place: tuple[str, ...], source: Path) -> None:
    """Put a source at a place, beside what exists there."""
    if not place:
        for entry in sorted(source.iterdir()) if source.is_dir() else ():
            _lay(tree, (entry.name,), entry)
    elif len(place) == 1 and place[0] not in tree:
        tree[place[0]] = _tree_of(source) if source.is_dir() else source
    elif place[0] != os.pardir:
        below = tree.setdefault(place[0], {})
        if isinstance(below, Path) and below.is_dir():
            below = tree[place[0]] = _tree_of(below)
        if isinstance(below, dict) and (len(place) > 1 or source.is_dir()):
            _lay(below, place[1:], source)


def _entries(tree: _Tree, above: str) -> Iterator[tuple[str, Path | None]]:
    """Yield the path of each folder, with None, and of each file, with the file that it links to."""
    for name, below in tree.items():
        path = f"{above}{name}"
        yield path, None if isinstance(below, dict) else below
        if isinstance(below, dict):
            yield from _entries(below, f"{path}/")
