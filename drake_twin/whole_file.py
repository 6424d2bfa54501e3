"""Files that are written completely or not at all."""

import contextlib
import io
import os
import secrets
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

from drake_twin.errors import RunError


def write_result(what: str, file: Path, content: str | bytes, otherwise: str = "") -> None:
    """Write a file whole.

    Args:
        what: What it is, for the error.
        file: The file.
        content: Its text, or its bytes.
        otherwise: What is left if it cannot be written, for the error.

    Raises:
        RunError: If it cannot be written.
    """
    try:
        write_whole(file, content)
    except OSError as error:
        raise RunError(f"the {what} {file} cannot be written ({error.strerror}){otherwise}") from None


def write_figure(what: str, file: Path, figure: Any, **more: Any) -> None:
    """Write a figure of Matplotlib whole, in the format of the file's suffix.

    Args:
        what: What it is, for the error.
        file: The file.
        figure: The figure.
        more: Options of its ``savefig``.

    Raises:
        RunError: If it cannot be drawn or written.
    """
    drawn = io.BytesIO()
    try:
        figure.savefig(drawn, format=file.suffix.lower().removeprefix("."), **more)
    except (ValueError, MemoryError) as error:
        raise RunError(f"the {what} {file} cannot be drawn ({error})") from None
    write_result(what, file, drawn.getvalue())


def write_whole(file: Path, content: str | bytes) -> None:
    """Write a file so that it is complete, or unchanged if the process is stopped or the disk fills up.

    Raises:
        OSError: If it cannot be written.
    """
    data = content.encode() if isinstance(content, str) else content
    file = file.resolve()
    if _has_to_stay(file):
        _write_in_place(file, data)
        return
    with _replaced(file) as stream:
        stream.write(data)


@contextlib.contextmanager
def whole_stream(file: Path) -> Iterator[BinaryIO]:
    """Open a file to write bit by bit; it is there when the block ends, and as before if that raises an error.

    Raises:
        OSError: If it cannot be written.
    """
    file = file.resolve()
    if _has_to_stay(file):
        with tempfile.TemporaryFile() as stream:
            yield stream
            stream.seek(0)
            _write_in_place(file, stream.read())
        return
    with _replaced(file) as replacing:
        yield replacing


def _has_to_stay(file: Path) -> bool:
    """Return whether a file cannot be replaced: a pipe, or one in a closed folder."""
    return file.exists() and not (file.is_file() and os.access(file.parent, os.W_OK))


@contextlib.contextmanager
def _replaced(file: Path) -> Iterator[BinaryIO]:
    """Open a file without a name, or with another one, that takes the place of a file when the block ends."""
    name = file.name.encode()[:200].decode(errors="ignore")
    part = file.with_name(f".{name}.{secrets.token_hex(4)}.part")
    descriptor, has_name = _open_part(part)
    try:
        with os.fdopen(descriptor, "wb") as stream:
            yield stream
            stream.flush()
            os.fsync(descriptor)
            if file.exists():
                os.fchmod(descriptor, file.stat().st_mode)
            if not has_name:
                os.link(f"/proc/self/fd/{descriptor}", part, src_dir_fd=descriptor)  # so that it follows the link
        os.replace(part, file)
    finally:
        part.unlink(missing_ok=True)


def _write_in_place(file: Path, data: bytes) -> None:
    """Write into a file that cannot be replaced; the space for it is there before its content goes."""
    with file.open("r+b" if file.is_file() else "wb") as stream:
        if file.is_file() and hasattr(os, "posix_fallocate"):
            size = file.stat().st_size
            try:
                os.posix_fallocate(stream.fileno(), 0, max(len(data), 1))
            except OSError:
                stream.truncate(size)
                raise
        stream.write(data)
        if file.is_file():
            stream.truncate()


def _open_part(part: Path) -> tuple[int, bool]:
    """Open a new file in a folder; return its descriptor and whether it has a name already.

    Where the system supports it, the file has no name until it is finished, so that even SIGKILL leaves nothing behind.
    """
    if hasattr(os, "O_TMPFILE") and os.path.isdir("/proc/self/fd"):  # needed to give it a name
        with contextlib.suppress(OSError):
            return os.open(part.parent, os.O_TMPFILE | os.O_WRONLY, 0o666), False
    return os.open(part, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666), True
