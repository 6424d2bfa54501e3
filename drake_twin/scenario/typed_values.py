"""Values of dataclasses against their annotated types: which do not fit, and what they should be."""

import dataclasses
import reprlib
import sys
import types
import typing
from collections.abc import Iterator, Mapping
from functools import cache
from math import isfinite
from typing import Any

from drake_twin.description.yaml_document import ValuePath


def misfits(value: Any, path: ValuePath) -> Iterator[tuple[ValuePath, str]]:
    """Find values that do not fit their annotated types, and numbers that are not finite.

    Args:
        value: A dataclass, or a value in one.
        path: The keys and indices that lead to it.

    Yields:
        The path of each, and what is wrong with it.
    """
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        for item in dataclasses.fields(value):
            below = getattr(value, item.name)
            wanted = _misfit(field_types(type(value))[item.name], below)
            if wanted is not None:
                yield (*path, item.name), f"{reprlib.repr(below)} is not {wanted}"
                return
            yield from misfits(below, (*path, item.name))
    elif isinstance(value, Mapping):
        for key, below in value.items():
            yield from misfits(below, (*path, key))
    elif isinstance(value, tuple) and path and path[-1] != "data":  # a command's data is checked by its controller
        for index, below in enumerate(value):
            yield from misfits(below, (*path, index))
    elif isinstance(value, float) and not isfinite(value):
        yield path, f"{value!r} is not a finite number"


def _misfit(kind: Any, value: Any) -> str | None:
    """Say what a value should be, where it does not fit the annotated type; return None where it fits."""
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is types.UnionType or origin is typing.Union:
        found = [_misfit(item, value) for item in arguments]
        return None if None in found else found[0]
    if kind is typing.Any:
        return None
    if kind is float:
        fits = isinstance(value, float) or (type(value) is int and abs(value) <= sys.float_info.max)
        return None if fits else "a number"
    if origin is tuple and arguments[-1] is not Ellipsis:
        fits = isinstance(value, tuple | list) and len(value) == len(arguments)
        if fits and not any(_misfit(float, item) for item in value):
            return None
        return f"{len(arguments)} numbers"
    if origin is tuple:
        fits = isinstance(value, tuple | list) and not any(_misfit(arguments[0], item) for item in value)
        return None if fits else "a list of such values"
    if origin is Mapping:
        fits = isinstance(value, Mapping) and not any(_misfit(arguments[1], item) for item in value.values())
        return None if fits else "a mapping of names to such values"
    names = {str: "text", bool: "true or false", type(None): "None"}
    return names.get(kind, "of this kind") if isinstance(kind, type) and not isinstance(value, kind) else None


@cache
def field_types(kind: type) -> dict[str, Any]:
    """Return the annotated type of each field of a dataclass."""
    return typing.get_type_hints(kind)
