"""JSON files that say what they are and in which version."""

import json
from pathlib import Path
from typing import Any

from drake_twin.errors import InputError, RunError


def write_saved(file: str | Path, kind: str, version: int, data: dict[str, Any]) -> None:
    """Writes plain data.

    Raises:
        RunError: the file cannot be written.
    """
    text = json.dumps({"format": f"drake_twin {kind}", "version": version, **data}, indent=1)
    try:
        Path(file).write_text(text + "\n", encoding="utf-8")
    except OSError as error:
        raise RunError(f"the {kind} cannot be saved to {file} ({error.strerror})") from None


def read_saved(file: str | Path, kind: str, version: int) -> dict[str, Any]:
    """Reads what `write_saved` wrote.

    Raises:
        InputError: the file cannot be read, or holds something else, or another version of it.
    """
    try:
        data = json.loads(Path(file).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise InputError(f"no {kind} can be read ({error})", file=file) from None
    if not isinstance(data, dict) or data.pop("format", None) != f"drake_twin {kind}":
        raise InputError(f"this is no {kind} of a twin", file=file)
    found = data.pop("version", None)
    if found != version:
        raise InputError(f"the {kind} was saved in version {found!r}, and only {version} can be read", file=file)
    return data
