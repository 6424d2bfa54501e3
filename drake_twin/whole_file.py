"""Files that are written whole or not at all."""

import contextlib
import os
import secrets
from pathlib import Path


def write_whole(file: Path, content: str | bytes) -> None:
    """Writes a file; whoever stops the process meanwhile, or fills the disk, finds it as it was before, or whole.

    Raises:
        OSError: it cannot be written.
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
                os.link(f"/proc/self/fd/{descriptor}", part, src_dir_fd=descriptor)  # which makes it follow the link
        os.replace(part, file)
    finally:
        part.unlink(missing_ok=True)


def _open_part(part: Path) -> tuple[int, bool]:
    """A new file in a folder, and whether it has its name already.

    Where the system can, it has none until it is finished: then nothing is left of it, even after SIGKILL.
    """
    if hasattr(os, "O_TMPFILE") and os.path.isdir("/proc/self/fd"):  # by which it gets its name
        with contextlib.suppress(OSError):
            return os.open(part.parent, os.O_TMPFILE | os.O_WRONLY, 0o666), False
    return os.open(part, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666), True
