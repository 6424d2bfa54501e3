"""A source package as it looks once installed: what ``$(find pkg)/urdf`` is when the folder is ``description/urdf``.

CMakeLists.txt is read, not run. The installed look is a folder of links in the system's temporary folder, which is made
only for packages whose two layouts differ.
"""

import atexit
import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

_INSTALL = re.compile(
    r"install\s*\(\s*DIRECTORY\s+(?P<folders>[^)]*?)\s+DESTINATION\s+[\"']?\$?\{?(?:CMAKE_INSTALL_PREFIX\}/)?share/"
    r"(?:\$\{PROJECT_NAME\}|[\w-]+)(?P<below>/[\w./-]*)?[\"']?",
    re.IGNORECASE,
)
_INSTALL_TO_SHARE = re.compile(r"ament_auto_package\s*\([^)]*INSTALL_TO_SHARE\s+(?P<folders>[^)]*)\)", re.IGNORECASE)

# Folders that packages install to the top of their share folder, wherever they keep them.
_USUAL_FOLDERS = {"config", "gazebo", "launch", "maps", "meshes", "models", "params", "ros2_control", "rviz"}
_USUAL_FOLDERS |= {"sdf", "srdf", "urdf", "worlds", "xacro"}


@lru_cache(maxsize=1024)
def installed_layout(package: Path) -> Path:
    """The folder of a package as its share folder would look; the package itself where that is the same.

    Args:
        package: the folder with the package.xml.
    """
    moved = {place: source for place, source in _moved_folders(package) if not (package / place).exists()}
    if not moved:
        return package
    view = _views() / str(len(os.listdir(_views()))) / package.name
    view.mkdir(parents=True)
    for entry in package.iterdir():
        (view / entry.name).symlink_to(entry)
    for place, source in moved.items():
        link = view / place
        if not os.path.lexists(link) and not any(
            parent.is_symlink() for parent in link.parents if view in parent.parents
        ):
            link.parent.mkdir(parents=True, exist_ok=True)
            link.symlink_to(source)
    return view


@lru_cache(maxsize=1)
def _views() -> Path:
    folder = Path(tempfile.mkdtemp(prefix="drake_twin_share_"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def _moved_folders(package: Path) -> Iterator[tuple[str, Path]]:
    """Place in the share folder, and the source folder that is installed there."""
    cmake = package / "CMakeLists.txt"
    if cmake.is_file():
        text = re.sub(r"#.*", "", cmake.read_text(encoding="utf-8", errors="replace"))
        for match in [*_INSTALL.finditer(text), *_INSTALL_TO_SHARE.finditer(text)]:
            below = (match.groupdict().get("below") or "").strip("/")
            for folder in match["folders"].split():
                yield from _installed(package, folder.strip("\"'"), below)
    elif not (package / "setup.py").is_file():
        # Neither build file is here (a collection of data files, say): the usual folders go to the top.
        for outer in sorted(path for path in package.iterdir() if path.is_dir() and path.name not in _USUAL_FOLDERS):
            for inner in sorted(path for path in outer.iterdir() if path.is_dir() and path.name in _USUAL_FOLDERS):
                yield inner.name, inner


def _installed(package: Path, folder: str, below: str) -> Iterator[tuple[str, Path]]:
    """``install(DIRECTORY a/b)`` installs b, ``install(DIRECTORY a/b/)`` what is in it."""
    source = package / folder
    if not source.is_dir():
        return
    if folder.endswith("/"):
        for entry in sorted(source.iterdir()):
            yield f"{below}/{entry.name}".strip("/"), entry
    else:
        yield f"{below}/{source.name}".strip("/"), source
