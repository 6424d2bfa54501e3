"""JSON files that contain their kind and version."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from drake_twin.description.source_file import check_regular
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


def read_saved(
    file: str | Path, kind: str, version: int, version_1: Callable[[dict[str, Any]], dict[str, Any]]
) -> dict[str, Any]:
    """Read what `write_saved` wrote.

    Args:
        file: The file.
        kind: What it holds, in words.
        version: The present version.
        version_1: Converts the entries of a file of version 1.

    Raises:
        InputError: If the file cannot be read, or holds something else, or an unknown version of it.
    """
    try:
        check_regular(Path(file))
        data = json.loads(Path(file).read_text(encoding="utf-8"))
    except (OSError, TypeError, UnicodeDecodeError, ValueError) as error:
        raise InputError(f"cannot read a {kind} ({error})", file=str(file)) from None
    except RecursionError:
        raise InputError(f"cannot read a {kind} (it is nested too deeply)", file=file) from None
    if not isinstance(data, dict) or data.pop("format", None) != f"drake_twin {kind}":
        raise InputError(f"this is not a {kind} of a twin", file=file)
    found = data.pop("version", None)
    if found == 1:
        return version_1(data)
    if found != version:
        raise InputError(f"the {kind} was saved in version {found!r}; 1 to {version} can be read", file=file)
    return data
