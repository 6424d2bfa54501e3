"""Types of fields in the notation of rosidl's Python classes (``get_fields_and_field_types``)."""

from collections.abc import Iterator
from typing import Any

from drake_twin.messages.interface_types import fields_of
from drake_twin.messages.store import EMPTY

_NAMES = {"bool": "boolean", "byte": "octet", "char": "uint8", "float32": "float", "float64": "double"}


def field_types(name: str) -> dict[str, list[tuple[str, str]]]:
    """Return the fields of a message and of those in it: each field's name, and its type such as ``sequence<double>``.

    Raises:
        ValueError: If the type is unknown.
    """
    found: dict[str, list[tuple[str, str]]] = {}
    pending = [name]
    while pending:
        if (kind := pending.pop()) not in found:
            fields = [field for field in fields_of(kind)[1] if field[0] != EMPTY]
            found[kind] = [(own, _notation(field)) for own, field in fields]
            pending += (inner for _, field in fields for inner in _messages(field))
    return found


def _notation(field: tuple[Any, Any]) -> str:
    from rosbags.interfaces import Nodetype

    node, details = field
    if node == Nodetype.NAME:
        package, _, own = details.split("/")
        return f"{package}/{own}"
    if node == Nodetype.ARRAY:
        return f"{_notation(details[0])}[{details[1]}]"
    if node == Nodetype.SEQUENCE:
        return f"sequence<{_notation(details[0])}{_bound(',', details[1])}>"
    name, bound = details
    return f"{_NAMES.get(name, name)}<{bound}>" if bound else str(_NAMES.get(name, name))


def _bound(before: str, bound: int) -> str:
    return f"{before}{bound}" if bound else ""


def _messages(field: tuple[Any, Any]) -> Iterator[str]:
    from rosbags.interfaces import Nodetype

    node, details = field
    if node == Nodetype.NAME:
        yield details
    elif node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        yield from _messages(details[0])
