"""Plain data as annotated types: scenarios, controllers' parameters, requests of the page, saved values.

The one reader of YAML and JSON into dataclasses. An error has the path of its value, from which a document has the
line, and the valid choices.
"""

import dataclasses
import reprlib
import sys
import types
import typing
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from enum import Enum
from functools import cache
from itertools import repeat
from math import inf, isfinite
from typing import Any, cast

from drake_twin.values import yaml_number

Key = str | int
ValuePath = tuple[Key, ...]

_UNIONS = (types.UnionType, typing.Union)
_LONGEST = 80  # characters of a value in an error


class Reader:
    """Read plain data as annotated types.

    These are dataclasses, tuples, mappings, unions of one of them with None or a mapping, enumerations, ``float`` (also
    written as text, as YAML 1.1 takes ``1e-3``), ``int``, ``bool``, ``str`` and ``Any``.

    Args:
        error: Makes an error from the path of a value, what is wrong with it, and ``value`` and ``valid`` of
            `InputError`.

    Attributes:
        are_finite: Whether a number must be finite.
        texts_of_numbers: Whether a number or a flag may stand where text is needed: YAML reads ``1`` as a number.
        largest: What the size of a whole number must be below.
    """

    are_finite = True
    texts_of_numbers = False
    largest = inf

    def __init__(self, error: Callable[..., Exception]):
        self.error = error

    def read(self, kind: Any, value: Any, path: ValuePath = ()) -> Any:
        """Return plain data as a type.

        Args:
            kind: The type.
            value: The data.
            path: The keys and indices that lead to it.

        Raises:
            Exception: What ``error`` makes, if it does not fit.
        """
        origin, arguments = typing.get_origin(kind), typing.get_args(kind)
        if dataclasses.is_dataclass(kind):
            return self.read_class(cast(type, kind), value, path)
        if origin in _UNIONS:
            kinds = [item for item in arguments if item is not types.NoneType]
            if value is None and len(kinds) < len(arguments):
                return None
            mapping = next((item for item in kinds if typing.get_origin(item) is Mapping), kinds[0])
            return self.read(mapping if isinstance(value, dict) else kinds[0], value, path)
        if origin is tuple:
            if not isinstance(value, list):
                raise self.error(path, f"{value!r} is not a list")
            kinds = [arguments[0]] * len(value) if arguments[-1] is Ellipsis else list(arguments)
            if len(kinds) != len(value):
                raise self.error(path, f"{value!r} has {len(value)} elements, but {len(kinds)} are needed")
            return tuple(self.read(kinds[index], item, (*path, index)) for index, item in enumerate(value))
        if origin is Mapping:
            if not isinstance(value, dict):
                raise self.error(path, f"{value!r} is not a mapping")
            return {str(key): self.read(arguments[1], item, (*path, key)) for key, item in value.items()}
        return value if kind is Any else self.read_scalar(kind, value, path)

    def read_class(self, kind: type, value: Any, path: ValuePath) -> Any:
        """Return a mapping as a dataclass."""
        if not isinstance(value, dict):
            raise self.error(path, f"{value!r} is not a mapping")
        kinds = field_types(kind)
        for key in value:
            if key not in kinds:
                raise self.error((*path, key), "unknown entry", value=str(key), valid=list(kinds))
        for item in dataclasses.fields(kind):
            if is_required(item) and item.name not in value:
                raise self.error(path, f"the entry {item.name!r} is missing")
        return kind(**{key: self.read(kinds[key], item, (*path, key)) for key, item in value.items()})

    def read_scalar(self, kind: Any, value: Any, path: ValuePath) -> Any:
        """Return a number, a flag, text, or a member of an enumeration."""
        is_whole = isinstance(value, int) and not isinstance(value, bool)
        is_number = isinstance(value, float) or (is_whole and abs(value) < self.largest)
        if issubclass(kind, Enum):
            valid = [item.value for item in kind]
            if value not in valid:
                raise self.error(path, f"unknown value {value!r}", value=str(value), valid=valid)
            return kind(value)
        if kind is float:
            number = yaml_number(value) if is_number or isinstance(value, str) else None
            if number is None or (self.are_finite and not isfinite(number)):
                shown = repr(value) if len(repr(value)) <= _LONGEST else repr(value)[:_LONGEST] + "…"
                raise self.error(path, f"{shown} is not a {'finite ' if self.are_finite else ''}number")
            return number
        if kind is int:
            if not is_number or (isinstance(value, float) and not value.is_integer()):
                raise self.error(path, f"{value!r} is not a whole number")
            return int(value)
        if kind is bool and not isinstance(value, bool):
            raise self.error(path, f"{value!r} is neither true nor false")
        if kind is str and not isinstance(value, str):
            if not self.texts_of_numbers or not isinstance(value, bool | int | float):
                raise self.error(path, f"{value!r} is not text")
            return str(value).lower() if isinstance(value, bool) else str(value)
        return value


def misfits(value: Any, path: ValuePath = (), unchecked: Collection[Key] = ()) -> Iterator[tuple[ValuePath, str]]:
    """Find values that do not fit their annotated types, and numbers that are not finite.

    Args:
        value: A dataclass, or a value in one.
        path: The keys and indices that lead to it.
        unchecked: Keys of lists whose items are not looked at.

    Yields:
        The path of each, and what is wrong with it.
    """
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        for item in dataclasses.fields(value):
            below = getattr(value, item.name)
            wanted = misfit(field_types(type(value))[item.name], below, (tuple, list))
            if wanted is not None:
                yield (*path, item.name), f"{reprlib.repr(below)} is not {wanted}"
                return
            yield from misfits(below, (*path, item.name), unchecked)
    elif isinstance(value, Mapping):
        for key, below in value.items():
            yield from misfits(below, (*path, key), unchecked)
    elif isinstance(value, tuple) and path and path[-1] not in unchecked:
        for index, below in enumerate(value):
            yield from misfits(below, (*path, index), unchecked)
    elif isinstance(value, float) and not isfinite(value):
        yield path, f"{value!r} is not a finite number"


def misfit(kind: Any, value: Any, sequences: tuple[type[Sequence[Any]], ...] = (tuple,)) -> str | None:
    """Say what a value should be, where it does not fit an annotated type; None where it fits, or none can tell.

    Args:
        kind: The type.
        value: The value.
        sequences: What counts as a tuple.
    """
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin in _UNIONS:
        found = [misfit(item, value, sequences) for item in arguments]
        return None if None in found else found[0]
    if origin is typing.Literal:
        return None if value in arguments else f"one of {', '.join(map(str, arguments))}"
    if origin is tuple:
        is_any_length = arguments[-1:] == (Ellipsis,)
        fits = isinstance(value, sequences) and (is_any_length or len(value) == len(arguments))
        kinds = repeat(arguments[0]) if is_any_length else arguments
        if fits and not any(misfit(item, each, sequences) for item, each in zip(kinds, value, strict=False)):
            return None
        return f"{len(arguments)} numbers" if {*arguments} == {float} else "a list of such values"
    if origin is list:
        fits = isinstance(value, list) and not any(misfit(arguments[0], item, sequences) for item in value)
        return None if fits else "a list of such values"
    if origin in (Mapping, dict):
        fits = isinstance(value, Mapping) and not any(misfit(arguments[1], item, sequences) for item in value.values())
        return None if fits else "a mapping of names to such values"
    if kind is float:
        fits = isinstance(value, float) or (type(value) is int and abs(value) <= sys.float_info.max)
        return None if fits else "a number"
    if kind is int:
        return None if isinstance(value, int) and not isinstance(value, bool) else "a whole number"
    kind = types.NoneType if kind is None else origin or kind
    if kind is Any or not isinstance(kind, type) or isinstance(value, kind):
        return None
    return {str: "text", bool: "true or false", types.NoneType: "None"}.get(kind, "of this kind")


@cache
def field_types(kind: Any) -> dict[str, Any]:
    """Return the annotated type of each field of a dataclass or named tuple."""
    hints = typing.get_type_hints(kind)
    names = [item.name for item in dataclasses.fields(kind)] if dataclasses.is_dataclass(kind) else kind._fields
    return {name: hints.get(name, Any) for name in names}


def is_required(item: "dataclasses.Field[Any]") -> bool:
    """Tell whether a field has no default."""
    return item.default is dataclasses.MISSING and item.default_factory is dataclasses.MISSING
