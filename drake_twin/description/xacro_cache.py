"""Expansions of xacro files in the user's cache folder: what one process has expanded, the next one reads.

Importing xacro takes 15 ms, and expanding a file from that up to seconds.
"""

import contextlib
import hashlib
import json
import os
from collections.abc import Mapping
from typing import NamedTuple

from drake_twin.description.mesh_cache import cache_folder, trim
from drake_twin.findings import Place
from drake_twin.versions import EXPANSIONS
from drake_twin.whole_file import write_whole

_MOST_BYTES = 128 * 1024**2

# A question of an expansion to its surroundings by its kind and its words, and the answer to it.
Answers = Mapping[tuple[str, tuple[str, ...]], str | list[str] | None]


class Expanded(NamedTuple):
    """The result of expanding a file.

    Attributes:
        text: The expanded XML.
        places: Where each of its elements was written, in the order of the document.
        warnings: Xacro's warnings.
    """

    text: str
    places: tuple[Place, ...]
    warnings: tuple[str, ...]


def kept_expansion(command: tuple[str, ...]) -> tuple[Answers, Expanded] | None:
    """Return what an expansion asked of its surroundings, and its result; None if it is not kept.

    Args:
        command: All that it depends on beside the answers.
    """
    with contextlib.suppress(OSError, ValueError, KeyError, TypeError, IndexError):  # it is not there, or broken
        file = cache_folder("xacro") / _name(command)
        seal, _, content = file.read_text(encoding="utf-8").partition("\n")
        if seal == _digest(content):
            os.utime(file)  # recently used files are kept longest
            found = json.loads(content)
            answers = {(kind, tuple(words)): answer for kind, words, answer in found["answers"]}
            places = tuple(Place(found["files"][file], line) for file, line in found["places"])
            return answers, Expanded(found["text"], places, tuple(found["warnings"]))
    return None


def keep_expansion(command: tuple[str, ...], answers: Answers, expanded: Expanded) -> None:
    """Keep an expansion, unless the cache cannot be written."""
    numbers = {place.file: 0 for place in expanded.places}
    numbers = {file: number for number, file in enumerate(numbers)}
    content = json.dumps(
        {
            "answers": [(kind, words, answer) for (kind, words), answer in answers.items()],
            "files": [*numbers],
            "places": [(numbers[place.file], place.line) for place in expanded.places],
            "text": expanded.text,
            "warnings": expanded.warnings,
        }
    )
    with contextlib.suppress(OSError):
        folder = cache_folder("xacro")
        write_whole(folder / _name(command), f"{_digest(content)}\n{content}")
        trim(folder, _MOST_BYTES)


def _name(command: tuple[str, ...]) -> str:
    import drake_twin

    return f"{_digest(json.dumps([EXPANSIONS.version, drake_twin.__version__, command]))}.json"


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
