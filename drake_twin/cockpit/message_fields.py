"""The fields of messages, each by its path, for example ``velocity[front_left_wheel_joint]`` or ``pose.position.x``."""

import re
from collections.abc import Iterator
from dataclasses import is_dataclass
from functools import lru_cache
from typing import Any

from drake_twin.errors import InputError
from drake_twin.messages.text import field_names

_PART = re.compile(r"(?:^|\.)(\w+)|\[([^\]]*)\]")
_NAMES = ("name", "joint_names", "interface_names")  # fields that name the elements of the others
_LONGEST_TEXT = 120


def field_rows(message: Any, most_elements: int = 32) -> Iterator[tuple[str, str, bool]]:
    """Yield the path of each field that is a number, a flag or a text, its text, and whether it is a number.

    Elements of joints' lists are named by their joints.

    Args:
        message: A ROS message.
        most_elements: How many elements of each list are listed.
    """
    return _rows(message, "", [], most_elements)


def number_at(message: Any, path: str) -> float:
    """Return the number at a path.

    Raises:
        InputError: If the message has no number there.
    """
    value, names = message, list[str]()
    for field, index in parts_of(path):
        names = names_in(value) or names
        try:
            value = getattr(value, field) if field else value[position_of(index, names)]
        except (AttributeError, IndexError, KeyError, TypeError, ValueError):
            raise InputError(f"the message has no field {path!r} now", value=path) from None
    if not _is_number(value):
        raise InputError(f"the field {path!r} is not a number", value=path)
    return float(value)


@lru_cache(1000)
def parts_of(path: str) -> tuple[tuple[str, str], ...]:
    """Return the parts of a path: each is a field's name, or the index or name of an element."""
    return tuple((match[1] or "", match[2] or "") for match in _PART.finditer(path))


def position_of(index: str, names: list[str]) -> int:
    """Return where an element is.

    Raises:
        ValueError: If no element has this name.
    """
    return int(index) if index.isdecimal() else names.index(index)


def _rows(value: Any, path: str, names: list[str], most: int) -> Iterator[tuple[str, str, bool]]:
    if is_dataclass(value):
        names = names_in(value) or names
        for name in field_names(value):
            yield from _rows(getattr(value, name), f"{path}.{name}" if path else name, names, most)
    elif isinstance(value, str):
        yield path, value if len(value) <= _LONGEST_TEXT else f"{value[:_LONGEST_TEXT]}…", False
    elif hasattr(value, "__len__"):
        are_named = len(value) == len(names) > 0 and path.rpartition(".")[2] not in _NAMES
        for index, item in enumerate(value[:most]):
            yield from _rows(item, f"{path}[{names[index] if are_named else index}]", names, most)
        if len(value) > most or not len(value):
            yield path, f"{len(value)} elements", False
    else:
        yield path, _text(value), _is_number(value)


def _text(value: Any) -> str:
    return f"{round(value, 9) + 0.0:.6g}" if isinstance(value, float) else str(value)


def names_in(value: Any) -> list[str]:
    """Return the names that a message gives the elements of its other fields."""
    for field in _NAMES:
        names = getattr(value, field, None)
        if isinstance(names, list) and all(isinstance(name, str) for name in names):
            return names
    return []


def _is_number(value: Any) -> bool:
    return hasattr(value, "__float__") and not hasattr(value, "__len__") and not isinstance(value, bool)
