"""The robots that a person can choose from: the robot files of all packages that are found."""

import os
import re
from collections.abc import Iterator
from pathlib import Path

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.share_layout import package_name
from drake_twin.description.source_file import regular_open

_ENDINGS = (".urdf", ".xacro", ".sdf")
_SKIPPED = {"meshes", "worlds", "test", "tests", "build", "node_modules", ".git"}
_MOST_FOLDERS = 300  # of one package
_BEGINNING = 1 << 16  # bytes
_ROBOT = re.compile(rb"<robot\b[^>]*\bname\s*=|<model\b[^>]*\bname\s*=")  # a file of macros alone names no robot
_WORLD = re.compile(rb"<world\b")


def robot_files(packages: PackageIndex) -> Iterator[str]:
    """Yield the addresses of robot files, ``package://…``, by package."""
    seen: set[str] = set()
    for folder in packages.packages():
        name = package_name(folder)
        if name is None or name in seen:
            continue
        seen.add(name)
        for file in sorted(_files(folder)):
            yield f"package://{name}/{file.relative_to(folder).as_posix()}"


def _files(package: Path) -> Iterator[Path]:
    for number, (folder, folders, names) in enumerate(os.walk(package)):
        if number == _MOST_FOLDERS:
            return
        folders[:] = [name for name in folders if name not in _SKIPPED]
        for name in names:
            if name.endswith(_ENDINGS) and _is_robot(Path(folder, name)):
                yield Path(folder, name)


def _is_robot(file: Path) -> bool:
    try:
        with regular_open(file, "rb") as opened:
            text = opened.read(_BEGINNING)
    except OSError:
        return False
    return _ROBOT.search(text) is not None and not (file.suffix == ".sdf" and _WORLD.search(text))
