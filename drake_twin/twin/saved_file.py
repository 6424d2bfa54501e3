"""JSON files that contain their kind and version."""

import json
import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

from drake_twin.description.source_file import MOST_BYTES, file_text
from drake_twin.errors import InputError, RunError
from drake_twin.versions import FileKind, head, stamp, written_by
from drake_twin.whole_file import write_whole

_log = logging.getLogger(__name__)


def write_saved(file: str | Path, kind: FileKind, data: dict[str, Any]) -> None:
    """Write plain data; if the process is stopped meanwhile, the file is complete or as before.

    Raises:
        RunError: If the file cannot be written.
    """
    text = json.dumps({**head(kind), **data}, indent=1) + "\n"
    try:
        write_whole(Path(file), text)
    except (OSError, TypeError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise RunError(f"the {kind.what} cannot be saved to {file!s} ({reason})") from None


def read_saved(
    file: str | Path, kind: FileKind, version_1: Callable[[dict[str, Any]], dict[str, Any]]
) -> dict[str, Any]:
    """Read what `write_saved` wrote.

    Args:
        file: The file.
        kind: What it holds.
        version_1: Converts the entries of a file of version 1.

    Raises:
        InputError: If the file cannot be read, or holds something else, or an unknown version of it.
    """
    try:
        data = json.loads(file_text(file, most=MOST_BYTES))
    except (OSError, TypeError, ValueError) as error:
        raise InputError(f"cannot read a {kind.what} ({error})", file=str(file)) from None
    except RecursionError:
        raise InputError(f"cannot read a {kind.what} (it is nested too deeply)", file=file) from None
    if not isinstance(data, dict) or data.pop("format", None) != f"drake_twin {kind.what}":
        raise InputError(f"this is not a {kind.what} of a twin", file=file)
    found = kind.check(data.pop("version", None), file)
    _compare(data.pop("written_by", None), kind, file)
    return version_1(data) if found == 1 else data


def _compare(wrote: Any, kind: FileKind, file: str | Path) -> None:
    """Warn where another Drake or another kind of machine wrote a file, for which no hash is promised."""
    if not isinstance(wrote, dict):  # before version 3
        return
    if any(wrote.get(name) != own for name, own in written_by().items() if name != "drake_twin"):
        there = f"Drake {wrote.get('drake')} on {wrote.get('machine')}"
        _log.warning("the %s %s is of %s, and this is %s: the last digits may differ", kind.what, file, there, stamp())
