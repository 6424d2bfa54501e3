"""JSON files that say what they are and in which version."""

import json
import os
from pathlib import Path
from typing import Any

from drake_twin.errors import InputError, RunError


def write_saved(file: str | Path, kind: str, version: int, data: dict[str, Any]) -> None:
    """Writes plain data; whoever stops the process meanwhile finds the file as it was before, or whole.

    Raises:
        RunError: the file cannot be written.
    """
    text = json.dumps({"format": f"drake_twin {kind}", "version": version, **data}, indent=1) + "\n"
    try:
        _write(Path(file).resolve(), text)
    except (OSError, TypeError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise RunError(f"the {kind} cannot be saved to {file!s} ({reason})") from None


def _write(file: Path, text: str) -> None:
    if file.exists() and not (file.is_file() and os.access(file.parent, os.W_OK)):  # a pipe, or in a closed folder
        file.write_text(text, encoding="utf-8")
        return
    part = file.with_name(f".{file.name[:200]}.{os.getpid()}.part")
    try:
        part.write_text(text, encoding="utf-8")
        os.replace(part, file)
    finally:
        part.unlink(missing_ok=True)


def read_saved(file: str | Path, kind: str, version: int) -> dict[str, Any]:
    """Reads what `write_saved` wrote.

    Raises:
        InputError: the file cannot be read, or holds something else, or another version of it.
    """
    try:
        data = json.loads(Path(file).read_text(encoding="utf-8"))
    except (OSError, TypeError, UnicodeDecodeError, ValueError) as error:
        raise InputError(f"no {kind} can be read ({error})", file=str(file)) from None
    except RecursionError:
        raise InputError(f"no {kind} can be read (it is nested without end)", file=file) from None
    if not isinstance(data, dict) or data.pop("format", None) != f"drake_twin {kind}":
        raise InputError(f"this is no {kind} of a twin", file=file)
    found = data.pop("version", None)
    if found != version:
        raise InputError(f"the {kind} was saved in version {found!r}, and only {version} can be read", file=file)
    return data
