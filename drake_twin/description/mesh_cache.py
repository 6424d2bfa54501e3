"""A content-addressed cache of converted meshes in the user's cache folder."""

import contextlib
import hashlib
import os
import re
import stat
import tempfile
from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path
from typing import TypeVar
from urllib.parse import unquote

from drake_twin.description.source_file import check_regular
from drake_twin.errors import InputError, RunError
from drake_twin.scratch_folder import scratch_folder
from drake_twin.versions import MESHES
from drake_twin.whole_file import write_whole

_T = TypeVar("_T")

# Part of every cached file's name: it changes when a conversion gives other files.
_CONVERSION = str(MESHES.version)

_MOST_BYTES = 2 * 1024**3


def mesh_cache_folder() -> Path:
    """Return the folder of converted meshes, see `cache_folder`."""
    return cache_folder("meshes")


def cache_folder(name: str) -> Path:
    """Return ``$XDG_CACHE_HOME/drake_twin/NAME``, or ``~/.cache/drake_twin/NAME``.

    Where neither can be written, it is ``drake_twin_UID/NAME`` in the system's temporary folder, if that belongs to
    this user alone, or else a new folder there.
    """
    base = Path(os.environ.get("XDG_CACHE_HOME", ""))
    with contextlib.suppress(OSError, RuntimeError):  # RuntimeError: a user without a home
        if not base.is_absolute():  # the specification says to ignore it
            base = Path("~/.cache").expanduser()
        folder = base / "drake_twin" / name
        folder.mkdir(parents=True, exist_ok=True)
        if os.access(folder, os.W_OK):
            return folder
    return _temporary_folder(name)


def in_cache(name: str, keep: Callable[[Path], _T]) -> _T:
    """Keep something in a folder of the cache; where that is full, in the one of the system's temporary folder.

    Args:
        name: The folder's name.
        keep: Keeps it in the folder that it is given.

    Returns:
        What the function returns.

    Raises:
        RunError: If neither can be written. It is not an `InputError`, which would be one of the file that is read.
    """
    folder = cache_folder(name)
    try:
        return keep(folder)
    except OSError as error:
        reason = error.strerror
    try:
        return keep(_temporary_folder(name))
    except OSError:
        elsewhere = f"name a place with space in XDG_CACHE_HOME, or make some in {tempfile.gettempdir()}"
        raise RunError(f"the cache {folder} cannot be written ({reason}): {elsewhere}") from None


def _temporary_folder(name: str) -> Path:
    folder = _temporary_base() / name
    folder.mkdir(exist_ok=True)
    return folder


@lru_cache(maxsize=1)
def _temporary_base() -> Path:
    base = Path(tempfile.gettempdir(), f"drake_twin_{os.getuid()}")
    with contextlib.suppress(OSError):
        base.mkdir(mode=0o700, exist_ok=True)
        status = base.lstat()  # of a link that another user has put there, too
        is_own = stat.S_ISDIR(status.st_mode) and status.st_uid == os.getuid() and not status.st_mode & 0o077
        if is_own and os.access(base, os.W_OK):
            return base
    return scratch_folder()


def cached(source: Path, suffix: str, convert: Callable[[Path], bytes]) -> Path:
    """Return the converted form of a mesh: from the cache, or converted now and kept.

    It is addressed by the content of the source: a changed mesh is converted again, a moved one is not. Two processes
    may fill the cache at once: a file appears whole or not at all.

    Args:
        source: The mesh file.
        suffix: The end of the converted file's name, for example ``.hull.obj``; it tells conversions apart.
        convert: Makes the converted file's bytes.

    Raises:
        InputError: If the source cannot be read.
        RunError: If the cache cannot be written, nor the temporary folder.
    """
    name = _digest(source) + suffix
    content: bytes | None = None

    def keep(folder: Path) -> Path:
        nonlocal content
        target = folder / name
        if _is_sound(target):
            with contextlib.suppress(OSError):
                os.utime(target)  # recently used files are kept longest
                os.utime(_seal(target))
            return target
        content = convert(source) if content is None else content
        write_whole(target, content)
        _seal(target).parent.mkdir(exist_ok=True)
        write_whole(_seal(target), hashlib.sha256(content).hexdigest())
        trim(folder, _MOST_BYTES)
        return target

    return in_cache("meshes", keep)


def note_source(target: Path, source: Path) -> None:
    """Keep where the mesh is of which a cached file was made, for `source_of`; without it where that cannot be kept."""
    note, text = _note(target), str(source.absolute())
    with contextlib.suppress(OSError, UnicodeError):
        if not note.is_file() or note.read_text(encoding="utf-8") != text:
            note.parent.mkdir(exist_ok=True)
            write_whole(note, text)


def source_of(target: Path) -> Path | None:
    """Return the mesh of which a cached file was made; None if it is unknown, gone or changed."""
    with contextlib.suppress(OSError, UnicodeError, InputError):
        source = Path(_note(target).read_text(encoding="utf-8"))
        if target.name.startswith(_digest(source)):
            return source
    return None


def _note(target: Path) -> Path:
    """Return the file with the path of a cached file's source."""
    return target.parent.with_name("mesh_sources") / f"{target.name}.txt"


def _seal(target: Path) -> Path:
    """Return the file with the checksum of a cached file."""
    return target.parent.with_name("mesh_checksums") / f"{target.name}.sha256"


def _is_sound(target: Path) -> bool:
    """Tell whether a file is in the cache, as it was written."""
    with contextlib.suppress(OSError):
        status = target.stat()
        return _is_version_sound(target, status.st_mtime_ns, status.st_size) if status.st_size else False
    return False


@lru_cache(maxsize=4096)
def _is_version_sound(target: Path, _modified: int, _size: int) -> bool:
    try:
        return hashlib.sha256(target.read_bytes()).hexdigest() == _seal(target).read_text(encoding="ascii")
    except (OSError, UnicodeDecodeError):
        return False


def _digest(source: Path) -> str:
    try:
        check_regular(source)
        status = source.stat()
        return _digest_of_version(source, status.st_mtime_ns, status.st_size)
    except OSError as error:
        raise InputError(f"the mesh cannot be read ({error.strerror})", file=source) from None


@lru_cache(maxsize=4096)
def _digest_of_version(source: Path, _modified: int, _size: int) -> str:
    content = source.read_bytes()
    digest = hashlib.sha256(content + source.suffix.lower().encode() + _CONVERSION.encode())
    for beside in _files_beside(source, content):
        digest.update(beside.read_bytes())
    return digest.hexdigest()


# How OBJ, MTL, COLLADA and glTF files name what is in their folder: materials, pictures, buffers.
_NAMES_BESIDE = {
    ".obj": re.compile(rb"^\s*mtllib\s+(.+?)\s*$", re.MULTILINE),
    ".mtl": re.compile(rb"^\s*(?i:map_\w+|bump|disp|decal|refl|norm)\s+((?:.*\s)?\S+)\s*$", re.MULTILINE),
    ".dae": re.compile(rb"<init_from>(?:\s*<ref>)?\s*([^<]+?)\s*<"),
    ".gltf": re.compile(rb'"uri"\s*:\s*"(?!data:)([^"]{1,1000})"'),
}


def check_files_beside(source: Path) -> None:
    """Check the files that a mesh names beside it: those that exist are regular files of reasonable size.

    Raises:
        InputError: If one is a device, a pipe or too large, which a reader of meshes would wait for.
        OSError: If the mesh cannot be read.
    """
    status = source.stat()
    _check_beside_version(source, status.st_mtime_ns, status.st_size)


@lru_cache(maxsize=4096)
def _check_beside_version(source: Path, _modified: int, _size: int) -> None:
    if source.suffix.lower() in _NAMES_BESIDE:
        for _ in _files_beside(source, source.read_bytes()):
            pass


def _files_beside(source: Path, content: bytes, known: frozenset[Path] = frozenset()) -> Iterator[Path]:
    """Yield the materials and pictures that a conversion includes, where they exist.

    Raises:
        InputError: If one is a device, a pipe or too large.
    """
    names = _NAMES_BESIDE.get(source.suffix.lower())
    for name in names.findall(content) if names is not None else ():
        for part in {name, *name.split()[-1:]}:  # of a picture: its name, perhaps after options
            beside = source.parent / unquote(part.decode(errors="replace")).removeprefix("file://")
            with contextlib.suppress(OSError, ValueError):
                if beside in known or beside.is_dir() or not beside.exists():
                    continue
                check_regular(beside)
                yield beside
                if beside.suffix.lower() == ".mtl":
                    yield from _files_beside(beside, beside.read_bytes(), known | {source, beside})


def trim(folder: Path, most: int) -> None:
    """Remove the files that were used longest ago from a folder with more than so many bytes, to three quarters."""
    files = []
    for entry in os.scandir(folder):
        with contextlib.suppress(OSError):  # another process may be trimming too
            files.append((entry.stat().st_mtime_ns, entry.stat().st_size, entry.path))
    total = sum(size for _, size, _ in files)
    if total <= most:
        return
    for _, size, path in sorted(files):
        if total <= 3 * most // 4:
            return
        with contextlib.suppress(OSError):
            os.unlink(path)
            os.unlink(_seal(Path(path)))
            os.unlink(_note(Path(path)))
        total -= size
