"""Files that are written completely or not at all."""

import contextlib
import os
import secrets
from pathlib import Path


def write_whole(file: Path, content: str | bytes) -> None:
    """Write a file so that it is complete, or unchanged if the process is stopped or the disk fills up.

    Raises:
        OSError: If it cannot be written.
    """
    data = content.encode() if isinstance(content, str) else content
    file = file.resolve()
    if file.exists() and not (file.is_file() and os.access(file.parent, os.W_OK)):  # a pipe, or in a closed folder
        file.write_bytes(data)
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


def _open_part(part: Path) -> tuple[int, bool]:
    """Open a new file in a folder; return its descriptor and whether it has a name already.

    Where the system supports it, the file has no name until it is finished, so that even SIGKILL leaves nothing behind.
    """
    if hasattr(os, "O_TMPFILE") and os.path.isdir("/proc/self/fd"):  # needed to give it a name
        with contextlib.suppress(OSError):
            return os.open(part.parent, os.O_TMPFILE | os.O_WRONLY, 0o666), False
    return os.open(part, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666), True
