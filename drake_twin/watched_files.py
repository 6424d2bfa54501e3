"""The files that a twin was made of, watched for changes."""

import contextlib
import os
import site
import sys
import sysconfig
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

_SUFFIXES = {".py", ".xml", ".yaml", ".yml", ".xacro", ".urdf", ".sdf", ".world", ".launch", ".stl", ".dae", ".obj"}
_SUFFIXES |= {".srdf", ".gltf", ".glb", ".ply", ".model", ".config", ".mjcf"}

_PERIOD = 0.3  # s

_collectors: list[set[str]] = []
_installed: list[bool] = []


def _hook(event: str, arguments: tuple[Any, ...]) -> None:
    if event == "open" and _collectors and isinstance(arguments[0], str | os.PathLike):
        mode = arguments[1]
        if mode is None or "r" in str(mode):
            for collector in _collectors:
                collector.add(os.path.abspath(os.fspath(arguments[0])))


@contextlib.contextmanager
def files_read() -> Iterator[set[Path]]:
    """Collects the user's files that are read by Python meanwhile: launch, xacro, YAML and mesh files.

    What belongs to Python, to this package or to its cache is left out.
    """
    if not _installed:  # an audit hook stays for ever, and is idle while nobody collects
        sys.addaudithook(_hook)
        _installed.append(True)
    opened: set[str] = set()
    found: set[Path] = set()
    _collectors.append(opened)
    try:
        yield found
    finally:
        _collectors.remove(opened)
        own = (str(Path(__file__).parent), *site.getsitepackages(), *sysconfig.get_paths().values())
        cache = f"{os.sep}drake_twin{os.sep}launch{os.sep}"
        found.update(
            Path(name)
            for name in opened
            if Path(name).suffix.lower() in _SUFFIXES and not name.startswith(own) and cache not in name
        )


class Watch:
    """Tells whether one of some files has changed.

    Args:
        files: the files; one that does not exist is waited for.

    Attributes:
        broken_off_by: the file whose change was found.
    """

    def __init__(self, files: set[Path]):
        self._stamps = {file: _stamp(file) for file in files}
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
    def files(self) -> set[Path]:
        """The files."""
        return set(self._stamps)

    def changed(self) -> Path | None:
        """A file that has changed since it was last asked about; None when none has."""
        for file, before in self._stamps.items():
            now = _stamp(file)
            if now != before:
                self._stamps[file] = now
                return file
        return None


def _stamp(file: Path) -> tuple[int, int] | None:
    try:
        status = file.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size
