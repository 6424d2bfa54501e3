"""The files that a twin was built from, watched for changes."""

import contextlib
import os
import site
import sys
import sysconfig
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from drake_twin.description.mesh_cache import cache_folder

_SUFFIXES = {".py", ".xml", ".yaml", ".yml", ".xacro", ".urdf", ".sdf", ".world", ".launch", ".stl", ".dae", ".obj"}
_SUFFIXES |= {".srdf", ".gltf", ".glb", ".ply", ".model", ".config", ".mjcf"}

_PERIOD = 0.3  # s between two looks at the files

# A file's modification time and size; None if the file does not exist.
Stamp = tuple[int, int] | None

_collectors: list[dict[Path, Stamp]] = []
_installed: list[bool] = []


def _hook(event: str, arguments: tuple[Any, ...]) -> None:
    if event == "open" and _collectors and isinstance(arguments[0], str | os.PathLike):
        mode = arguments[1]
        if mode is None or "r" in str(mode):
            file = Path(os.path.abspath(os.fspath(arguments[0])))
            if file.suffix.lower() in _SUFFIXES:
                for collector in _collectors:
                    collector.setdefault(file, _stamp(file))


@contextlib.contextmanager
def files_read() -> Iterator[dict[Path, Stamp]]:
    """Collect the user's files that Python reads inside the block: launch, xacro, YAML and mesh files.

    Each has the stamp of when it was opened first. Files of Python, of this package and of its cache are left out.
    """
    if not _installed:  # an audit hook cannot be removed; without a collector it does nothing
        sys.addaudithook(_hook)
        _installed.append(True)
    opened: dict[Path, Stamp] = {}
    found: dict[Path, Stamp] = {}
    _collectors.append(opened)
    try:
        yield found
    finally:
        _collectors[:] = [collector for collector in _collectors if collector is not opened]
        paths = sysconfig.get_paths()
        own = [Path(__file__).parent.parent, cache_folder("launch").parent, *map(Path, site.getsitepackages())]
        own += [Path(paths[name]) for name in ("stdlib", "platstdlib", "purelib", "platlib")]
        found.update(
            (file, stamp) for file, stamp in opened.items() if not any(file.is_relative_to(folder) for folder in own)
        )


class Watch:
    """Watches files for changes.

    Args:
        files: The files with their stamps when they were read, see `files_read`; creating a missing one is a change.

    Attributes:
        changed_file: The changed file that `poll` has found.
    """

    def __init__(self, files: Mapping[Path, Stamp]):
        self._stamps = dict(files)
        self._next_look = 0.0
        self.changed_file: Path | None = None

    @property
    def has_changed(self) -> bool:
        """Whether `poll` has found a changed file."""
        return self.changed_file is not None

    def poll(self) -> bool:
        """Return whether a file has changed; the files are looked at a few times a second at most."""
        now = time.monotonic()
        if now >= self._next_look:
            self._next_look = now + _PERIOD
            self.changed_file = self.next_change()
        return self.has_changed

    @property
    def files(self) -> dict[Path, Stamp]:
        """The files with their stamps at the last look."""
        return dict(self._stamps)

    def renewed(self, files: Mapping[Path, Stamp]) -> "Watch":
        """Return a watch of further files besides these, which are cached and so not read again."""
        return type(self)(self._stamps | dict(files))

    def next_change(self) -> Path | None:
        """Return a file that has changed since the last call; None without one."""
        for file, before in self._stamps.items():
            now = _stamp(file)
            if now != before:
                self._stamps[file] = now
                return file
        return None


def _stamp(file: Path) -> Stamp:
    try:
        status = file.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size
