"""JSON files that contain their kind and version."""

import json
from pathlib import Path
from typing import Any

from drake_twin.errors import InputError, RunError
from drake_twin.whole_file import write_whole


def write_saved(file: str | Path, kind: str, version: int, data: dict[str, Any]) -> None:
    """Write plain data; if the process is stopped meanwhile, the file is complete or as before.

    Raises:
        RunError: If the file cannot be written.
    """
    text = json.dumps({"format": f"drake_twin {kind}", "version": version, **data}, indent=1) + "\n"
    try:
        write_whole(Path(file), text)
    except (OSError, TypeError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise RunError(f"the {kind} cannot be saved to {file!s} ({reason})") from None


def read_saved(file: str | Path, kind: str, version: int) -> dict[str, Any]:
    """Read a file that `write_saved` wrote.

    Raises:
        InputError: If the file cannot be read, or has another kind or version.
    """
    try:
        data = json.loads(Path(file).read_text(encoding="utf-8"))
    except (OSError, TypeError, UnicodeDecodeError, ValueError) as error:
        raise InputError(f"cannot read a {kind} ({error})", file=str(file)) from None
    except RecursionError:
        raise InputError(f"cannot read a {kind} (it is nested too deeply)", file=file) from None
    if not isinstance(data, dict) or data.pop("format", None) != f"drake_twin {kind}":
        raise InputError(f"this is not a {kind} of a twin", file=file)
    found = data.pop("version", None)
    if found != version:
        raise InputError(f"the {kind} was saved in version {found!r}, and only {version} can be read", file=file)
    return data
