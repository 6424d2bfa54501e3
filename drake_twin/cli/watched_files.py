"""The files that a twin was made of, watched for changes."""

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

_PERIOD = 0.3  # s

# A file's time of change and size; None where there is no file.
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
    """Collects the user's files that are read by Python meanwhile: launch, xacro, YAML and mesh files.

    Each is there as it was when it was opened first. What belongs to Python, to this package or to its cache is left
    out.
    """
    if not _installed:  # an audit hook stays for ever, and is idle while nobody collects
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
    """Tells whether one of some files has changed.

    Args:
        files: the files as they were when they were read, see `files_read`; one that does not exist is waited for.

    Attributes:
        broken_off_by: the file whose change was found.
    """

    def __init__(self, files: Mapping[Path, Stamp]):
        self._stamps = dict(files)
        self._next_look = 0.0
        self.broken_off_by: Path | None = None

    @property
    def is_broken_off(self) -> bool:
        """Whether `breaks_off` has found a change."""
        return self.broken_off_by is not None

    def breaks_off(self) -> bool:
        """Whether a file has changed, looked at a few times a second."""
        now = time.monotonic()
        if now >= self._next_look:
            self._next_look = now + _PERIOD
            self.broken_off_by = self.changed()
        return self.is_broken_off

    @property
    def files(self) -> dict[Path, Stamp]:
        """The files as they were when it last looked."""
        return dict(self._stamps)

    def changed(self) -> Path | None:
        """A file that has changed since it was last asked about; None when none has."""
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
