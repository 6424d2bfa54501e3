"""Files that are written completely or not at all."""

import contextlib
import io
import os
import secrets
from pathlib import Path
from typing import Any

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
    if file.exists() and not (file.is_file() and os.access(file.parent, os.W_OK)):  # a pipe, or in a closed folder
        _write_in_place(file, data)
        return
    name = file.name.encode()[:200].decode(errors="ignore")
    part = file.with_name(f".{name}.{secrets.token_hex(4)}.part")
    descriptor, has_name = _open_part(part)
    try:
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(data)
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
