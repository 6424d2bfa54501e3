"""Files that are written whole or not at all."""

import os
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
    part = file.with_name(f".{file.name[:200]}.{os.getpid()}.part")
    try:
        with part.open("wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        if file.exists():
            part.chmod(file.stat().st_mode)
        os.replace(part, file)
    finally:
        part.unlink(missing_ok=True)
