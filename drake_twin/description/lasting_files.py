"""Files that the twin writes into the user's cache: each at the same path in every run, by its content."""

import contextlib
import hashlib
from pathlib import Path

from drake_twin.description.mesh_cache import in_cache
from drake_twin.whole_file import write_whole


def lasting_folder(content: str) -> Path:
    """Return a folder in the user's cache for what belongs to a text; the same in every run for that text.

    Raises:
        RunError: If the cache cannot be written.
    """
    return in_cache("launch", lambda folder: _made(folder, content))


def lasting_file(name: str, text: str) -> Path:
    """Return a file of a name with a text in the user's cache, written unless it exists.

    Raises:
        RunError: If the cache cannot be written.
    """

    def keep(folder: Path) -> Path:
        path = _made(folder, text) / name
        with contextlib.suppress(OSError, UnicodeDecodeError):
            if path.read_text(encoding="utf-8") == text:
                return path
        write_whole(path, text)
        return path

    return in_cache("launch", keep)


def _made(folder: Path, content: str) -> Path:
    made = folder / hashlib.sha256(content.encode()).hexdigest()[:16]
    made.mkdir(exist_ok=True)
    return made
